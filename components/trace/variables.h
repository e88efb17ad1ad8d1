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
  double share = 0.0;  // of the left-out squared error
  double rms = 0.0;    // of the part it predicts, in units of the target
};

struct VariableScan {
  std::vector<VariableScore> scores;  // best first
  double placebo_99 = 0.0;            // best false share
};

// Free curves over time, and the same times the angle: what drifts. No columns without motion in
// time.
Eigen::MatrixXd DriftColumns(const identify::Design& design);

// The design's drive must be predicted (Design::PredictDrive): the measured one is the target
// itself.
VariableScan ScanVariables(const identify::Design& design,
                           const std::vector<identify::Block>& blocks,
                           const Eigen::Ref<const Eigen::MatrixXd>& base,
                           const Eigen::Ref<const Eigen::VectorXd>& target, int folds,
                           int placebo_rounds, std::uint64_t seed);

}  // namespace sinew::trace
