// Rigid-body dynamics of a tree on a floating base: Bullet's articulated body algorithm in double
// precision.
//
//     H(q) nu' + h(q, nu) = F,    nu = (w_WB, v_WB, q'),    F = (n, f, tau)
//
// Vectors of the base are in the world's axes: w_WB, rad/s, is the base link's angular velocity,
// v_WB, m/s, the velocity of the base link's origin; n, Nm, is a moment about that origin and f, N,
// a force on the base link. q', tau: rad/s and Nm, of a prismatic joint m/s and N, in the order of
// the chain's moving bodies. nu' holds ordinary (not spatial) accelerations: w' and the second
// derivative of the origin's position (Featherstone: Rigid Body Dynamics Algorithms, 2.11 and ch.
// 9).
// Links are set up as RigidChain sets them up (multi_body.h). Thread: one. After the first Solve
// and Responses nothing is allocated.
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <span>
#include <vector>

#include "components/base/types/gravity.h"
#include "components/bodies/links/bodies.h"

namespace sinew::world {

inline constexpr int kBaseBody = -1;
inline constexpr int kBaseFreedom = 6;

struct FloatingState {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();             // of the base link's origin
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();  // unit; base to world axes
  Eigen::VectorXd joint_position_rad;                               // m of a prismatic joint
  Eigen::VectorXd velocity;                                         // nu, 6 + joints
};

// state = state moved for time_s at constant nu: the orientation by the exponential of the angular
// velocity, q <- exp(w_W t / 2) q, so that it stays on the unit sphere. Allocates nothing.
void Drift(double time_s, FloatingState* state) noexcept;

// A force on a body at a point.
struct LinkForce {
  int body = kBaseBody;                               // index of a body, or kBaseBody
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();  // in the link's frame
  Eigen::Vector3d force_N = Eigen::Vector3d::Zero();  // world axes
};

// Position and velocity of a point, world axes.
struct PointMotion {
  Eigen::Vector3d position_m, velocity_m_s;
};

// An inertia that acts on the velocity of a point alone: along the world's axes, kg.
struct PointInertia {
  int body = kBaseBody;
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();  // in the link's frame
  Eigen::Vector3d mass_kg = Eigen::Vector3d::Zero();
};

class FloatingChain {
 public:
  // gravity: world axes. Throws std::invalid_argument: the base has no mass, or an inertia that no
  // body has (a principal moment not above 0, or above the sum of the two others).
  explicit FloatingChain(
      const arm::Chain& chain,
      const Eigen::Vector3d& gravity_m_s2 = Eigen::Vector3d(0.0, 0.0, -types::kGravity_m_s2));
  ~FloatingChain();
  FloatingChain(FloatingChain&&) noexcept;
  FloatingChain& operator=(FloatingChain&&) noexcept;

  int joint_count() const;
  int freedom() const { return kBaseFreedom + joint_count(); }
  int body_count() const;
  // Joints: the free ones (arm::IsFree). Body index of each, in joint order.
  const std::vector<int>& joint_bodies() const;
  // For every component of nu the one next to it on the way to the base, -1 for the first: those
  // before it on this way are all that it shares an entry of H with (TreeFactor).
  const std::vector<int>& parents() const;
  double mass_kg() const;  // of all bodies
  const Eigen::Vector3d& gravity_m_s2() const;

  // At the origin, upright, joints at 0, at rest.
  FloatingState Rest() const;

  // Vectors must have the chain's sizes.
  void SetState(const FloatingState& state) noexcept;

  // In the state of the last SetState. body: an index, or kBaseBody.
  Eigen::Isometry3d Pose(int body) const noexcept;  // link to world
  PointMotion Point(int body, const Eigen::Vector3d& point_m) const noexcept;
  // Kinetic and potential energy, J; angular momentum about the centre of mass, kg m^2/s, world.
  double Energy() const noexcept;
  Eigen::Vector3d AngularMomentum() const noexcept;
  Eigen::Vector3d CenterOfMass() const noexcept;

  // J, 3 x freedom: the velocity of a point, world axes, is J nu.
  void Jacobian(int body, const Eigen::Vector3d& point_m,
                Eigen::Ref<Eigen::Matrix3Xd> jacobian) const noexcept;
  // H + sum over `added` of J' diag(mass) J, freedom x freedom, by the composite-rigid-body
  // algorithm (Featherstone: Rigid Body Dynamics Algorithms, 6.2 and 9.3) about the base link's
  // origin.
  void Inertia(std::span<const PointInertia> added, Eigen::Ref<Eigen::MatrixXd> inertia) noexcept;

  // nu' for joint torques (one a joint) and external forces; gravity acts in addition.
  void Solve(const Eigen::Ref<const Eigen::VectorXd>& torque_Nm, std::span<const LinkForce> forces,
             Eigen::Ref<Eigen::VectorXd> acceleration) noexcept;

  // H^-1, freedom x freedom, in the state of the last Solve: column k is the response of nu' to a
  // unit of F[k].
  void Responses(Eigen::Ref<Eigen::MatrixXd> inverse_inertia) noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sinew::world
