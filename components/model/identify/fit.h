// Fits the free parameters of a joint model to recordings, with their uncertainties.
// Pure; allocates; throws TooLittleData when there are fewer rows than parameters.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "components/model/actuator/model.h"
#include "components/model/identify/balance.h"
#include "components/model/identify/block_regression.h"
#include "components/model/identify/design.h"
#include "components/model/identify/too_little_data.h"

namespace sinew::identify {

struct FitResult {
  actuator::JointModel model;    // fitted values, half widths filled in
  Balance balance;               // at the fitted nonlinear parameters
  Eigen::VectorXd coefficients;  // of balance.columns
  Eigen::MatrixXd covariance;    // of the linear parameters in physical units, as Physical()
  Eigen::VectorXd residual;      // torque at the output, every row
  double rms = 0.0;              // of the residual over used rows
  double percent = 0.0;          // 100 |residual| / |drive torque| over used rows
};

// Error of a model as it is on any design.
struct ModelError {
  double rms = 0.0;
  double percent = 0.0;
  Eigen::VectorXd residual;
};
ModelError ErrorOf(const Design& design, const actuator::JointModel& model);
// The same in torques of the reference's drive factor. Models that differ in it are distinguished
// by the drive signal that they predict; a larger factor makes the same error a larger torque.
ModelError ErrorOf(const Design& design, const actuator::JointModel& model,
                   const actuator::JointModel& reference);

// Linear parameters by least squares over used rows; half widths from block scores with the t
// quantile of blocks - 1. Nonlinear parameters stay.
FitResult FitModel(const Design& design, const actuator::JointModel& model,
                   const std::vector<Block>& blocks);

}  // namespace sinew::identify
