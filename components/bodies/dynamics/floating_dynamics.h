// Inverse dynamics of a tree on a floating base, and its regressor:
//
//     F = H(q) nu' + h(q, nu) = Y phi,    nu = (w_WB, v_WB, q'),    F = (n, f, tau)
//
// in the conventions of sim/world/floating_chain.h. Vectors of the base are in the world's axes:
// w_WB, rad/s, is the base link's angular velocity, v_WB, m/s, the velocity of its origin; n, Nm,
// is the moment about that origin and f, N, the force that the base needs from outside beside
// gravity. q', tau: rad/s and Nm, of a prismatic joint m/s and N, in the order of the chain's
// moving bodies, driven or not. nu' holds ordinary (not spatial) accelerations. The base's position
// plays no part.
//
// phi: ten parameters (inertial.h) of the base, then of every moving body, about the origin of its
// link frame, in its axes. Bodies on fixed joints are part of the body that carries them. Equations
// and sources: newton_euler.h; the base begins the recursion with its own motion
// (Featherstone: Rigid Body Dynamics Algorithms, 9.3). Thread: one.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "components/base/types/gravity.h"
#include "components/bodies/dynamics/dynamics.h"
#include "components/bodies/dynamics/newton_euler.h"
#include "components/bodies/links/bodies.h"

namespace sinew::arm {

inline constexpr int kBaseFreedom = 6;

struct FloatingMotion {
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();  // unit; base to world axes
  Eigen::VectorXd joint_position_rad;                               // m of a prismatic joint
  Eigen::VectorXd velocity;                                         // nu, 6 + joints
  Eigen::VectorXd acceleration;                                     // nu'
};

class FloatingDynamics {
 public:
  // Throws std::invalid_argument: a body whose weight is not the bodies' (Body::weightless).
  explicit FloatingDynamics(
      const Chain& chain,
      const Eigen::Vector3d& gravity_m_s2 = Eigen::Vector3d(0.0, 0.0, -types::kGravity_m_s2));

  int joints() const { return static_cast<int>(links_.size()); }
  int freedom() const { return kBaseFreedom + joints(); }
  int parameters() const { return kParametersPerBody * (1 + joints()); }
  const std::vector<std::string>& joint_names() const { return joint_names_; }
  // "link.m", "link.mx", ..., "link.Izz", the base's first
  const std::vector<std::string>& parameter_names() const { return parameter_names_; }
  const Eigen::VectorXd& nominal() const { return nominal_; }  // of the URDF
  double mass_kg() const;                                      // of all bodies, nominal

  // Joints at 0, upright, at rest.
  FloatingMotion Rest() const;

  // F, freedom entries, by the recursion. Vectors must have the sizes of Rest. Allocates nothing.
  void Force(const FloatingMotion& motion, const Eigen::Ref<const Eigen::VectorXd>& phi,
             Eigen::Ref<Eigen::VectorXd> force) noexcept;
  // Y, freedom x parameters. Allocates.
  Eigen::MatrixXd Regressor(const FloatingMotion& motion);

 private:
  void Forward(const FloatingMotion& motion) noexcept;

  std::vector<MovingLink> links_;
  std::vector<std::string> joint_names_, parameter_names_;
  Eigen::VectorXd nominal_;
  Eigen::Vector3d gravity_;
  // Scratch; the base first.
  std::vector<LinkMotion> motions_;
  std::vector<LinkWrench> wrenches_;
};

// Parameters that forces on the base and torques of any motion can show; seed: of the states.
BaseParameters FindBaseParameters(FloatingDynamics& dynamics, unsigned seed = 1);

}  // namespace sinew::arm
