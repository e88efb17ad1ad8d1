// The true structure, refitted on the same data: what the best tracer could reach.
#pragma once

#include <string>
#include <vector>

#include "components/actuator/model.h"
#include "components/identify/design.h"

namespace sinew::bank {

struct Oracle {
  actuator::JointModel model;
  double rms = 0.0;          // of the residual on the same data
  bool significant = false;  // a parameter of it is larger than its half width
  double value = 0.0;        // main parameter of the first term
};

// Has a true structure that a fit can be given: an effect of the balance of torques, and no event,
// whose instants would have to be found.
bool KnownToMotion(const std::string& effect, const actuator::JointModel& model);

// The linear parameter that says how large a term is: the largest one.
const actuator::ParameterValue& MainParameter(const actuator::Term& term);

// Every setting of the grid tried, the best one refined; the design's drive is predicted by it.
Oracle FitOracle(identify::Design* train, const actuator::JointModel& declared,
                 const std::vector<std::string>& names);

}  // namespace sinew::bank
