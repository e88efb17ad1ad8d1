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

struct ParameterRef {
  int term = 0;
  int linear = 0;
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
  // Writes coefficients into a model of the same terms.
  void Apply(const Eigen::Ref<const Eigen::VectorXd>& coefficients,
             actuator::JointModel* model) const;
};

// fits_scale: is the drive factor fitted, as it was for coefficients of other recordings, which may
// have had another known torque? Empty: as the design's own known torques allow.
Balance MakeBalance(const Design& design, const actuator::JointModel& model,
                    std::optional<bool> fits_scale = std::nullopt);

}  // namespace sinew::identify
