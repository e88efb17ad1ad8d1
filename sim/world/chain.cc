#include "sim/world/chain.h"

#include <stdexcept>
#include <string>

#include "components/base/types/joints.h"
#include "sim/world/multi_body.h"

namespace sinew::world {

struct RigidChain::Impl {
  MultiBody multi;
  btAlignedObjectArray<btScalar> scratch_r, force, response;
  btAlignedObjectArray<btVector3> scratch_v;
  btAlignedObjectArray<btMatrix3x3> scratch_m;
};

RigidChain::RigidChain(const arm::Chain& chain, const Eigen::Vector3d& gravity_m_s2)
    : impl_(std::make_unique<Impl>()) {
  impl_->multi = MakeMultiBody(chain, gravity_m_s2, /*fixed_base=*/true);
  if (joint_count() > types::kMaxJoints) {
    throw std::invalid_argument(std::to_string(joint_count()) +
                                " moving joints, expected at most " +
                                std::to_string(types::kMaxJoints));
  }
  impl_->force.resize(6 + joint_count());
  impl_->response.resize(6 + joint_count());
}

RigidChain::~RigidChain() = default;
RigidChain::RigidChain(RigidChain&&) noexcept = default;

int RigidChain::joint_count() const { return static_cast<int>(impl_->multi.joint_bodies.size()); }
const std::vector<int>& RigidChain::joint_bodies() const { return impl_->multi.joint_bodies; }

void RigidChain::SetState(const JointVector& position, const JointVector& velocity) noexcept {
  for (int j = 0; j < joint_count(); ++j) {
    const int body = impl_->multi.joint_bodies[static_cast<std::size_t>(j)];
    impl_->multi.body->setJointPos(body, position[j]);
    impl_->multi.body->setJointVel(body, velocity[j]);
  }
}

void RigidChain::Solve(JointVector* acceleration, JointMatrix* inverse_inertia) noexcept {
  btMultiBody& multi = *impl_->multi.body;
  const int n = joint_count();
  acceleration->resize(n);
  inverse_inertia->resize(n, n);
  multi.clearForcesAndTorques();
  for (int i = 0; i < multi.getNumLinks(); ++i) {
    multi.addLinkForce(i, impl_->multi.weight_N[static_cast<std::size_t>(i)]);
  }
  // Bullet adds dt x acceleration to the velocities: with dt = 1 the difference is the
  // acceleration.
  JointVector velocity(n);
  for (int j = 0; j < n; ++j) {
    velocity[j] = multi.getJointVel(impl_->multi.joint_bodies[static_cast<std::size_t>(j)]);
  }
  multi.computeAccelerationsArticulatedBodyAlgorithmMultiDof(
      1.0, impl_->scratch_r, impl_->scratch_v, impl_->scratch_m, false, false, false);
  for (int j = 0; j < n; ++j) {
    const int body = impl_->multi.joint_bodies[static_cast<std::size_t>(j)];
    (*acceleration)[j] = multi.getJointVel(body) - velocity[j];
    multi.setJointVel(body, velocity[j]);
  }
  for (int k = 0; k < impl_->force.size(); ++k) impl_->force[k] = 0.0;
  for (int j = 0; j < n; ++j) {
    impl_->force[6 + j] = 1.0;
    multi.calcAccelerationDeltasMultiDof(&impl_->force[0], &impl_->response[0], impl_->scratch_r,
                                         impl_->scratch_v);
    impl_->force[6 + j] = 0.0;
    for (int k = 0; k < n; ++k) (*inverse_inertia)(k, j) = impl_->response[6 + k];
  }
}

}  // namespace sinew::world
