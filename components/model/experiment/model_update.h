// Identified values into a joint's model: which term gets which, and a line of history.
#pragma once

#include <string>
#include <vector>

#include "components/model/actuator/model.h"
#include "components/model/experiment/result.h"

namespace sinew::experiment {

// Writes what the result identified into terms that the model has: play, gravity, Coulomb friction,
// pneumatic torque, rotor inertia and viscous friction (at the output: times the ratio squared).
// The half width of the interval goes with the value. Adds a line of history for each. Returns what
// was changed, a line each; nothing: the model has no term for this result.
std::vector<std::string> UpdateModel(const Result& result, const std::string& recording,
                                     const std::string& when, actuator::JointModel* model);

}  // namespace sinew::experiment
