// Inverse dynamics of a fixed-base tree, and its regressor: tau = Y(q, v, a) phi.
//
// Per moving body ten parameters about the origin of its link frame, in its axes:
//
//     phi = m, m c (3), Ixx, Ixy, Ixz, Iyy, Iyz, Izz        (I about the origin)
//     f = m a + dw x (m c) + w x (w x (m c)),   n = (m c) x a + I dw + w x (I w)
//
// with a the acceleration of the origin less gravity, w and dw the angular velocity and
// acceleration, all in the link's axes (Khalil, Dombre: Modeling, Identification and Control of
// Robots (2002), 9.3; Featherstone: Rigid Body Dynamics Algorithms, 5.3). Bodies on fixed joints
// are part of the body that carries them. rad, Nm; a prismatic joint m, N. Pure; allocates.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "components/arm/bodies.h"

namespace sinew::arm {

inline constexpr int kParametersPerBody = 10;

class ArmDynamics {
 public:
  // Throws std::invalid_argument when no joint moves.
  explicit ArmDynamics(const Chain& chain,
                       const Eigen::Vector3d& gravity_m_s2 = Eigen::Vector3d(0.0, 0.0, -9.81));

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
  struct Link {
    int parent = -1;  // moving link
    bool prismatic = false;
    Eigen::Isometry3d parent_from_joint = Eigen::Isometry3d::Identity();
    Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  };
  // Of one link, in its axes.
  struct Motion {
    Eigen::Matrix3d parent_from_link;
    Eigen::Vector3d origin_in_parent;
    Eigen::Vector3d w, dw, a;
  };
  std::vector<Motion> Forward(const Eigen::Ref<const Eigen::VectorXd>& q,
                              const Eigen::Ref<const Eigen::VectorXd>& v,
                              const Eigen::Ref<const Eigen::VectorXd>& a) const;

  std::vector<Link> links_;
  std::vector<std::string> joint_names_, parameter_names_;
  Eigen::VectorXd nominal_;
  Eigen::Vector3d gravity_;
};

// Which parameters the torques of any motion can show. The other columns of Y are combinations of
// the independent ones: Y_dependent = Y_independent K, so beta = phi_independent + K phi_dependent
// is all that can be identified (Gautier, Khalil: IEEE Trans. Robotics and Automation 6 (1990)
// 368).
struct BaseParameters {
  std::vector<int> independent, dependent;
  Eigen::MatrixXd K;  // independent x dependent

  Eigen::VectorXd Of(const Eigen::Ref<const Eigen::VectorXd>& phi) const;
};

// By a rank-revealing QR of regressors at random states; the seed decides those.
BaseParameters FindBaseParameters(const ArmDynamics& dynamics, unsigned seed = 1);

}  // namespace sinew::arm
