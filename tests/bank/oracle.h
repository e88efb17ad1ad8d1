// The true structure, refitted on the same data: what the best tracer could reach.
#pragma once

#include <optional>
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

// The balance that shows an effect, when a fit can be given its true structure there; none for
// events, whose instants would have to be found, and for what is outside the catalogue.
std::optional<effects::Balance> BalanceOf(const std::string& effect,
                                          const actuator::JointModel& model);

// The linear parameter that says how large a term is: the largest one.
const actuator::ParameterValue& MainParameter(const actuator::Term& term);

// In the balance of the declared model. Every setting of the grid tried, the best one refined; the
// design's drive is predicted by it.
Oracle FitOracle(identify::Design* train, const actuator::JointModel& declared,
                 const std::vector<std::string>& names);

}  // namespace sinew::bank
