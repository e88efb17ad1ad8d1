// Inverse dynamics of a fixed-base tree, and its regressor: tau = Y(q, v, a) phi.
//
// phi: per moving body the ten parameters of inertial.h about the origin of its link frame, in its
// axes. Equations and sources: newton_euler.h. Bodies on fixed joints are part of the body that
// carries them. rad, Nm; a prismatic joint m, N. Pure; allocates.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "components/base/types/gravity.h"
#include "components/bodies/dynamics/newton_euler.h"
#include "components/bodies/links/bodies.h"

namespace sinew::arm {

class ArmDynamics {
 public:
  // Throws std::invalid_argument when no joint moves.
  explicit ArmDynamics(const Chain& chain, const Eigen::Vector3d& gravity_m_s2 =
                                               Eigen::Vector3d(0.0, 0.0, -types::kGravity_m_s2));

  int joints() const { return static_cast<int>(links_.size()); }
  int parameters() const { return kParametersPerBody * joints(); }
  const std::vector<std::string>& joint_names() const { return joint_names_; }
  // "link.m", "link.mx", ..., "link.Izz"
  const std::vector<std::string>& parameter_names() const { return parameter_names_; }
  const Eigen::VectorXd& nominal() const { return nominal_; }  // of the URDF

  // joints x parameters.
  Eigen::MatrixXd Regressor(const Eigen::Ref<const Eigen::VectorXd>& q,
                            const Eigen::Ref<const Eigen::VectorXd>& v,
                            const Eigen::Ref<const Eigen::VectorXd>& a) const;
  // The same torque by the recursion itself.
  Eigen::VectorXd Torque(const Eigen::Ref<const Eigen::VectorXd>& q,
                         const Eigen::Ref<const Eigen::VectorXd>& v,
                         const Eigen::Ref<const Eigen::VectorXd>& a,
                         const Eigen::Ref<const Eigen::VectorXd>& phi) const;

 private:
  std::vector<LinkMotion> Forward(const Eigen::Ref<const Eigen::VectorXd>& q,
                                  const Eigen::Ref<const Eigen::VectorXd>& v,
                                  const Eigen::Ref<const Eigen::VectorXd>& a) const;

  std::vector<MovingLink> links_;
  std::vector<std::string> joint_names_, parameter_names_;
  Eigen::VectorXd nominal_;
  Eigen::Vector3d gravity_;
};

// Parameters that the torques of any motion can show. The other columns of Y are combinations of
// the independent ones: Y_dependent = Y_independent K, so beta = phi_independent + K phi_dependent
// is all that can be identified (Gautier, Khalil: IEEE Trans. Robotics and Automation 6 (1990)
// 368).
struct BaseParameters {
  std::vector<int> independent, dependent;
  Eigen::MatrixXd K;  // independent x dependent

  Eigen::VectorXd Of(const Eigen::Ref<const Eigen::VectorXd>& phi) const;
};

// Base parameters of regressors stacked row by row, of more rows than columns, at states that
// excite everything: by a rank-revealing QR.
BaseParameters BaseParametersOf(const Eigen::Ref<const Eigen::MatrixXd>& regressors);

// At random states; the seed decides those.
BaseParameters FindBaseParameters(const ArmDynamics& dynamics, unsigned seed = 1);

}  // namespace sinew::arm
