// Models of a joint, term by term, for the tests of controllers.
#pragma once

#include <cstddef>
#include <vector>

#include "components/model/actuator/model.h"

namespace sinew::control {

// Adds the named effect with its parameters in the order of the catalogue.
inline void AddTerm(actuator::JointModel* model, const char* effect, std::vector<double> linear,
                    std::vector<double> nonlinear = {}) {
  actuator::Term term = actuator::MakeTerm(effect, model->constants);
  for (std::size_t i = 0; i < linear.size(); ++i) term.linear.at(i).value = linear[i];
  for (std::size_t i = 0; i < nonlinear.size(); ++i) term.nonlinear.at(i).value = nonlinear[i];
  model->terms.push_back(term);
}

}  // namespace sinew::control
