// Fit of a joint model (trace/whitened_fit.h makes it), and the error of a model on recordings.
// Pure; allocates.
#pragma once

#include <Eigen/Core>

#include "components/model/actuator/model.h"
#include "components/model/identify/balance.h"
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

}  // namespace sinew::identify
