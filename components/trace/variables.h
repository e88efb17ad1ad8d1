// Which signal a residual follows, without naming an effect: a free curve (eight knots) of one
// variable, or one harmonic of an angle, beside the model's own terms, by the same cross-validation
// and placebo.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "components/identify/block_regression.h"
#include "components/identify/design.h"
#include "components/trace/cross_validation.h"

namespace sinew::trace {

struct VariableScore {
  std::string variable;  // field of JointSample
  double order_per_turn = 0.0;
  Gain gain;
  double size_in_errors = 0.0;  // of the curve, jackknife over units
  double share = 0.0;           // of the left-out squared error
  double rms = 0.0;             // of the part it predicts, in units of the target
};

struct VariableScan {
  std::vector<VariableScore> scores;  // best first
  double placebo_99 = 0.0;            // quantile of the best false share
};

// Free curves over time, and the same times the angle, both without what is there all the time:
// what drifts. No columns without motion in time.
Eigen::MatrixXd DriftColumns(const identify::Design& design);

// Share of a residual's power that its level carries, twenty levels per recording.
double LevelShare(const identify::Design& design,
                  const Eigen::Ref<const Eigen::VectorXd>& residual);

// The design's drive must be predicted (Design::PredictDrive): the measured one is the target
// itself.
VariableScan ScanVariables(const identify::Design& design,
                           const std::vector<identify::Block>& blocks,
                           const Eigen::Ref<const Eigen::MatrixXd>& base,
                           const Eigen::Ref<const Eigen::VectorXd>& target, int folds,
                           int placebo_rounds, double placebo_quantile, std::uint64_t seed);

}  // namespace sinew::trace
