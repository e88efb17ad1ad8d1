// The declared model with the terms of a set of effects. Pure; allocates.
#pragma once

#include <vector>

#include "components/model/actuator/model.h"
#include "components/model/trace/problem.h"

namespace sinew::trace {

// terms: numbers of those of each member of the set, in the model that is returned. Sizes are those
// of the set's fit, in physical units.
actuator::JointModel ModelWith(const actuator::JointModel& declared, const Problem& problem,
                               const EffectSet& set, std::vector<std::vector<int>>* terms);

}  // namespace sinew::trace
