// How much of a residual is noise, and how much a model without physics could predict.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "components/identify/balance.h"
#include "components/identify/block_regression.h"
#include "components/identify/design.h"

namespace sinew::trace {

struct NoiseFloor {
  double rms = 0.0;    // torque at the output, after the parallel filter; 0: unknown
  std::string source;  // "standstill", "sample-to-sample scatter", ""
};

// From spells at rest (drive and known torques, straight line removed from each), and from the
// scatter of the drive from sample to sample, taken as white: the lower one.
NoiseFloor EstimateNoiseFloor(const identify::Design& design, const identify::Balance& balance,
                              double drive_factor);

// Columns of a flexible model: random tanh features of position, velocity and its sign,
// acceleration, drive, pressure and load (Rahimi, Recht 2007), each standardised, through the
// parallel filter.
Eigen::MatrixXd FlexibleColumns(const identify::Design& design, int count, std::uint64_t seed);

struct FlexibleFit {
  double left_out_share = 0.0;  // of the residual variance, by cross-validation
  Eigen::VectorXd remainder;    // target minus base and flexible part, fitted to the other folds
};

// Base and flexible columns together, ridge on the flexible ones (best of four by
// cross-validation).
FlexibleFit FitFlexible(const std::vector<identify::Block>& blocks,
                        const Eigen::Ref<const Eigen::MatrixXd>& base,
                        const Eigen::Ref<const Eigen::MatrixXd>& flexible,
                        const Eigen::Ref<const Eigen::VectorXd>& target, int folds);

}  // namespace sinew::trace
