// Rigid-body dynamics of a fixed-base tree: Bullet's articulated body algorithm in double
// precision.
//
//     q'' = a0 + A tau,   a0: accelerations without joint torque (gravity, Coriolis),   A = H(q)^-1
//
// Joints are the free ones (arm::IsFree); inertia and weight of those that mimic them act on them.
// Links are set up with their frame in the principal axes of their inertia, without damping, with
// the gyroscopic term and without velocity limits, so that the equations are the textbook ones
// (Featherstone: Rigid Body Dynamics Algorithms, ch. 7). Thread: one. Solve allocates nothing after
// the first call.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "components/base/types/gravity.h"
#include "components/base/types/joints.h"
#include "components/bodies/links/bodies.h"

namespace sinew::world {
using JointVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, types::kMaxJoints, 1>;
using JointMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor,
                                  types::kMaxJoints, types::kMaxJoints>;

class RigidChain {
 public:
  // Joints in the order of the chain's bodies. gravity: world frame. Throws
  // std::invalid_argument when there are too many joints.
  explicit RigidChain(const arm::Chain& chain,
                      const Eigen::Vector3d& gravity_m_s2 = Eigen::Vector3d(0.0, 0.0,
                                                                            -types::kGravity_m_s2));
  ~RigidChain();
  RigidChain(RigidChain&&) noexcept;

  int joint_count() const;
  // Body index of each joint, in joint order.
  const std::vector<int>& joint_bodies() const;

  void SetState(const JointVector& position, const JointVector& velocity) noexcept;
  void Solve(JointVector* acceleration, JointMatrix* inverse_inertia) noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sinew::world
