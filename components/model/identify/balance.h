// The balance of a joint as a linear regression.
//
//     sum over terms = 0:   eta D + K + sum theta_i phi_i = 0
//
// D: drive term with factor 1, from the measured drive; K: terms whose parameters are all known
// exactly (load force, declared payload); theta: what is fitted. With a factor eta that is fitted
// too, the measured drive is the target:
//
//     D = -(1 / eta) K - sum (theta_i / eta) phi_i
//
// so the known torques set the scale. With a fixed factor the target is eta D + K. When nothing
// known excites the balance, eta cannot be distinguished from the scale of all the others and stays
// at its nominal value. Pure; allocates.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "components/model/actuator/model.h"
#include "components/model/identify/design.h"

namespace sinew::identify {

// A linear parameter of a model.
struct ParameterRef {
  std::size_t term = 0;
  std::size_t linear = 0;

  const actuator::ParameterValue& In(const actuator::JointModel& model) const {
    return model.terms[term].linear[linear];
  }
  actuator::ParameterValue& In(actuator::JointModel* model) const {
    return model->terms[term].linear[linear];
  }
};

struct Balance {
  Eigen::VectorXd target;
  Eigen::MatrixXd columns;               // scale column first when the drive factor is fitted
  std::vector<ParameterRef> parameters;  // of the columns behind the scale column
  bool fits_scale = false;
  double drive_factor = 1.0;  // nominal, or exact when the scale is not fitted
  ParameterRef drive;
  Eigen::VectorXd nominal;       // coefficients at the model's present values
  Eigen::VectorXd spread;        // what a tolerance is in coefficients; 0: not stated
  Eigen::VectorXd drive_torque;  // D

  // Parameters from coefficients, the drive factor first when it is fitted.
  Eigen::VectorXd Physical(const Eigen::Ref<const Eigen::VectorXd>& coefficients) const;
  // Drive factor that coefficients stand for.
  double Scale(const Eigen::Ref<const Eigen::VectorXd>& coefficients) const;
  // Torque of one unit of the target: that factor where it is fitted, else 1.
  double Unit(const Eigen::Ref<const Eigen::VectorXd>& coefficients) const {
    return fits_scale ? Scale(coefficients) : 1.0;
  }
  Eigen::Index scale_columns() const { return fits_scale ? 1 : 0; }
  // Parameter of a column; of the scale column the drive's.
  const ParameterRef& ParameterOf(Eigen::Index column) const {
    return column < scale_columns()
               ? drive
               : parameters[static_cast<std::size_t>(column - scale_columns())];
  }
  // Writes coefficients into a model of the same terms.
  void Apply(const Eigen::Ref<const Eigen::VectorXd>& coefficients,
             actuator::JointModel* model) const;
};

// fits_scale: is the drive factor fitted, as it was for coefficients of other recordings, which may
// have had another known torque? Empty: as the design's own known torques allow.
Balance MakeBalance(const Design& design, const actuator::JointModel& model,
                    std::optional<bool> fits_scale = std::nullopt);

// Contribution of a term, with another value of its nonlinear parameter k,
// at the used rows.
Eigen::VectorXd ShapedTorque(const Design& design, const actuator::Term& term, std::size_t k,
                             double value);

// Fit of a joint model (trace/whitened_fit.h makes it).
struct FitResult {
  actuator::JointModel model;    // fitted values, half widths filled in
  Balance balance;               // at the fitted nonlinear parameters
  Eigen::VectorXd coefficients;  // of balance.columns
  Eigen::MatrixXd covariance;    // of the linear parameters in physical units, as Physical()
};

// Error of a model as it is on any design.
struct ModelError {
  double rms = 0.0;          // of the residual over used rows
  double percent = 0.0;      // 100 |residual| / |drive torque| over used rows
  Eigen::VectorXd residual;  // torque at the output, every row
};
ModelError ErrorOf(const Design& design, const actuator::JointModel& model);
// The same in torques of the reference's drive factor. Models that differ in it are distinguished
// by the drive signal that they predict; a larger factor makes the same error a larger torque.
ModelError ErrorOf(const Design& design, const actuator::JointModel& model,
                   const actuator::JointModel& reference);

}  // namespace sinew::identify
