// A data set as the comparison uses it: split as published and with a validation part, and which of
// its samples are quiet. Pure.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "components/base/types/run.h"
#include "reproduction/networks/dataset/dataset.h"
#include "reproduction/networks/samples.h"

namespace sinew::reproduction {

struct ComparisonSet {
  networks::Samples published;  // all training samples are used for training
  networks::Samples fair;       // the last part of every piece decides when training stops
  Eigen::VectorXd quiet;        // a value a sample: 1 where it belongs to the quiet part, else 0
  double deviation = 0.0;       // standard deviation of the targets, in their own unit
  double duration_s = 0.0;
};

// Quiet is, by task: the link at a stop of the play (sea), slower than 0.3 rad/s (pea), the piston
// slower than 1 mm/s (force). Throws std::invalid_argument.
ComparisonSet MakeComparisonSet(const std::vector<types::Run>& runs, networks::Task task,
                                double period_s);

// Adds the mean squared error of the test samples to `quiet` and `busy`, by where it arises.
// predicted: outputs x samples, normalised as the targets are.
void AddParts(const ComparisonSet& set, const Eigen::MatrixXd& predicted,
              const networks::Samples& samples, double* quiet, double* busy);

}  // namespace sinew::reproduction
