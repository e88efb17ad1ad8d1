// Data sets of the surrogate for the tasks of reproduction/networks/dataset, made in process.
//
// sea: 110 s as in 5.1.2. pea: 350 s as in 5.1.3 (100 strokes of a hand), with the level of the
// motor's torque changed every second or so: the source does not say how it varied, and a motor in
// torque mode with a constant set point has a constant torque, of which nothing can be learned but
// the noise of the current (ConstantTorqueNoiseShare). Deterministic for a seed.
#pragma once

#include <cstdint>
#include <vector>

#include "components/base/types/run.h"
#include "reproduction/networks/dataset/dataset.h"
#include "sim/surrogate/experiment.h"

namespace sinew::reproduction {

// Of the training samples: what stops a training, and the samples between it and what teaches.
inline constexpr double kValidationShare = 0.2;
inline constexpr int kGap = 12;

struct SetOptions {
  networks::Task task = networks::Task::kSea;  // sea or pea
  double duration_s = 0.0;                     // 0: as above
  // Every set is of another specimen, its parameters off by up to this share.
  double spread = 0.05;
  std::uint64_t seed = 1;
  std::uint64_t specimen_seed = 0;  // 0: seed; else several sets are of one specimen
  bool constant_torque = false;     // pea with one set point, as it could also be read
};

types::Run RunOf(const std::vector<surrogate::LogRow>& rows, const std::string& name);
// Throws std::invalid_argument.
types::Run MakeSurrogateRun(const SetOptions& options);

// Variance of the noise of the target's sensor, in the target's unit squared: what no model can
// predict. From the surrogate's parameters.
double NoiseFloor(networks::Task task);

// The same of any smooth signal, from its third differences: var(d3) / 20, by their median.
double NoiseFromDifferences(const Eigen::VectorXd& signal);

}  // namespace sinew::reproduction
