#include "sim/world/chain.h"

#include <stdexcept>
#include <string>

#include "sim/world/multi_body.h"

namespace sinew::world {

struct RigidChain::Impl {
  MultiBody multi;
};

RigidChain::RigidChain(const arm::Chain& chain, const Eigen::Vector3d& gravity_m_s2)
    : impl_(std::make_unique<Impl>()) {
  impl_->multi = MakeMultiBody(chain, gravity_m_s2, /*fixed_base=*/true);
  if (joint_count() > types::kMaxJoints) {
    throw std::invalid_argument(std::to_string(joint_count()) +
                                " moving joints, expected at most " +
                                std::to_string(types::kMaxJoints));
  }
}

RigidChain::~RigidChain() = default;
RigidChain::RigidChain(RigidChain&&) noexcept = default;

int RigidChain::joint_count() const { return static_cast<int>(impl_->multi.joint_bodies.size()); }
const std::vector<int>& RigidChain::joint_bodies() const { return impl_->multi.joint_bodies; }

void RigidChain::SetState(const JointVector& position, const JointVector& velocity) noexcept {
  impl_->multi.SetPositions(position);
  impl_->multi.SetVelocities(velocity);
}

void RigidChain::Solve(JointVector* acceleration, JointMatrix* inverse_inertia) noexcept {
  MultiBody& multi = impl_->multi;
  const std::size_t n = multi.joint_bodies.size();
  acceleration->resize(joint_count());
  inverse_inertia->resize(joint_count(), joint_count());
  multi.body->clearForcesAndTorques();
  for (int i = 0; i < multi.body->getNumLinks(); ++i) {
    multi.body->addLinkForce(i, multi.weight_N[static_cast<std::size_t>(i)]);
  }
  multi.Accelerate();
  for (std::size_t j = 0; j < n; ++j) {
    (*acceleration)[static_cast<Eigen::Index>(j)] = multi.response[multi.Entry(j)];
  }
  for (std::size_t j = 0; j < n; ++j) {
    multi.force[multi.Entry(j)] = 1.0;
    multi.Respond();
    multi.force[multi.Entry(j)] = 0.0;
    for (std::size_t k = 0; k < n; ++k) {
      (*inverse_inertia)(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(j)) =
          multi.response[multi.Entry(k)];
    }
  }
}

}  // namespace sinew::world
