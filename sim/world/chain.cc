#include "sim/world/chain.h"

#include <BulletDynamics/Featherstone/btMultiBody.h>

#include <Eigen/Eigenvalues>
#include <stdexcept>
#include <string>

#include "components/types/joints.h"

namespace sinew::world {

namespace {

constexpr double kUnlimited = 1e12;

btVector3 ToBullet(const Eigen::Vector3d& v) { return btVector3(v.x(), v.y(), v.z()); }

btTransform ToBullet(const Eigen::Isometry3d& frame) {
  const Eigen::Quaterniond q(frame.linear());
  return btTransform(btQuaternion(q.x(), q.y(), q.z(), q.w()), ToBullet(frame.translation()));
}

// The principal frame of a body in its link's frame, and its principal moments.
struct Principal {
  btTransform frame = btTransform::getIdentity();
  btVector3 moments{0.0, 0.0, 0.0};
};

Principal PrincipalOf(const arm::Body& body) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(body.inertia_kg_m2);
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  frame.translate(body.com_m);
  Eigen::Matrix3d axes = solver.eigenvectors();
  if (axes.determinant() < 0.0) axes.col(0) *= -1.0;
  frame.rotate(axes);
  return {ToBullet(frame), ToBullet(Eigen::Vector3d(solver.eigenvalues().cwiseMax(0.0)))};
}

}  // namespace

struct RigidChain::Impl {
  std::unique_ptr<btMultiBody> body;
  std::vector<int> joint_bodies;
  std::vector<btVector3> weight_N;  // per link
  btAlignedObjectArray<btScalar> scratch_r, force, response;
  btAlignedObjectArray<btVector3> scratch_v;
  btAlignedObjectArray<btMatrix3x3> scratch_m;
};

RigidChain::RigidChain(const arm::Chain& chain, const Eigen::Vector3d& gravity_m_s2)
    : impl_(std::make_unique<Impl>()) {
  const int count = static_cast<int>(chain.bodies.size());
  impl_->body = std::make_unique<btMultiBody>(count, 1.0, btVector3(1.0, 1.0, 1.0),
                                              /*fixedBase=*/true, /*canSleep=*/false);
  btMultiBody& multi = *impl_->body;
  std::vector<Principal> principal;
  for (int i = 0; i < count; ++i) {
    const arm::Body& body = chain.bodies[static_cast<std::size_t>(i)];
    principal.push_back(PrincipalOf(body));
    const btTransform parent_frame = body.parent < 0
                                         ? btTransform::getIdentity()
                                         : principal[static_cast<std::size_t>(body.parent)].frame;
    // Bullet's frames are the principal ones: A joint in the parent's, B joint in the link's own.
    const btTransform a = parent_frame.inverse() * ToBullet(body.parent_from_joint);
    const btTransform b = principal.back().frame.inverse();
    const btQuaternion rotation = b.getRotation() * a.getRotation().inverse();
    const btVector3 axis = quatRotate(b.getRotation(), ToBullet(body.axis));
    const btVector3& moments = principal.back().moments;
    if (!body.moves) {
      multi.setupFixed(i, body.mass_kg, moments, body.parent, rotation, a.getOrigin(),
                       -b.getOrigin());
    } else if (body.prismatic) {
      multi.setupPrismatic(i, body.mass_kg, moments, body.parent, rotation, axis, a.getOrigin(),
                           -b.getOrigin(), true);
    } else {
      multi.setupRevolute(i, body.mass_kg, moments, body.parent, rotation, axis, a.getOrigin(),
                          -b.getOrigin(), true);
    }
    if (body.moves) impl_->joint_bodies.push_back(i);
    const Eigen::Vector3d weight =
        body.weightless ? Eigen::Vector3d::Zero().eval() : (body.mass_kg * gravity_m_s2).eval();
    impl_->weight_N.push_back(ToBullet(weight));
  }
  if (static_cast<int>(impl_->joint_bodies.size()) > types::kMaxJoints) {
    throw std::invalid_argument(std::to_string(impl_->joint_bodies.size()) +
                                " moving joints, expected at most " +
                                std::to_string(types::kMaxJoints));
  }
  multi.finalizeMultiDof();
  multi.setHasSelfCollision(false);
  multi.setLinearDamping(0.0);
  multi.setAngularDamping(0.0);
  multi.setUseGyroTerm(true);
  multi.setMaxAppliedImpulse(kUnlimited);
  multi.setMaxCoordinateVelocity(kUnlimited);
  impl_->force.resize(6 + joint_count());
  impl_->response.resize(6 + joint_count());
}

RigidChain::~RigidChain() = default;
RigidChain::RigidChain(RigidChain&&) noexcept = default;

int RigidChain::joint_count() const { return static_cast<int>(impl_->joint_bodies.size()); }
const std::vector<int>& RigidChain::joint_bodies() const { return impl_->joint_bodies; }

void RigidChain::SetState(const JointVector& position, const JointVector& velocity) noexcept {
  for (int j = 0; j < joint_count(); ++j) {
    const int body = impl_->joint_bodies[static_cast<std::size_t>(j)];
    impl_->body->setJointPos(body, position[j]);
    impl_->body->setJointVel(body, velocity[j]);
  }
}

void RigidChain::Solve(JointVector* acceleration, JointMatrix* inverse_inertia) noexcept {
  btMultiBody& multi = *impl_->body;
  const int n = joint_count();
  acceleration->resize(n);
  inverse_inertia->resize(n, n);
  multi.clearForcesAndTorques();
  for (int i = 0; i < multi.getNumLinks(); ++i) {
    multi.addLinkForce(i, impl_->weight_N[static_cast<std::size_t>(i)]);
  }
  // Bullet adds dt x acceleration to the velocities: with dt = 1 the difference is the
  // acceleration.
  JointVector velocity(n);
  for (int j = 0; j < n; ++j) {
    velocity[j] = multi.getJointVel(impl_->joint_bodies[static_cast<std::size_t>(j)]);
  }
  multi.computeAccelerationsArticulatedBodyAlgorithmMultiDof(
      1.0, impl_->scratch_r, impl_->scratch_v, impl_->scratch_m, false, false, false);
  for (int j = 0; j < n; ++j) {
    const int body = impl_->joint_bodies[static_cast<std::size_t>(j)];
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
