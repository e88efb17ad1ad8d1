// Small imperfections that every set-up has, as columns with priors: channels half a sample apart,
// valves that take some samples to open, teeth that give less than the encoder rounds. Without them
// every clean recording would be an alarm (effects::Smallest). Pure; allocates.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "components/actuator/model.h"
#include "components/identify/design.h"
#include "components/trace/used_rows.h"

namespace sinew::trace {

struct Nuisances {
  Eigen::MatrixXd columns;  // used rows, with the sign of a balance's columns
  Eigen::VectorXd spread;   // prior standard deviation of each coefficient, around 0
  std::vector<std::string> names;
};

// Of the model's balance; what the model holds as a term is no nuisance, nor is what is left out by
// name.
Nuisances MakeNuisances(const identify::Design& design, const UsedRows& used,
                        const actuator::JointModel& model,
                        const std::vector<std::string>& left_out);

}  // namespace sinew::trace
