#include "sim/world/multi_body.h"

#include <Eigen/Eigenvalues>

namespace sinew::world {

namespace {

constexpr double kUnlimited = 1e12;

}  // namespace

btVector3 ToBullet(const Eigen::Vector3d& v) { return btVector3(v.x(), v.y(), v.z()); }

btTransform ToBullet(const Eigen::Isometry3d& frame) {
  const Eigen::Quaterniond q(frame.linear());
  return btTransform(btQuaternion(q.x(), q.y(), q.z(), q.w()), ToBullet(frame.translation()));
}

Principal PrincipalOf(const Eigen::Vector3d& com_m, const Eigen::Matrix3d& inertia_kg_m2) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(inertia_kg_m2);
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  frame.translate(com_m);
  Eigen::Matrix3d axes = solver.eigenvectors();
  if (axes.determinant() < 0.0) axes.col(0) *= -1.0;
  frame.rotate(axes);
  return {ToBullet(frame), ToBullet(Eigen::Vector3d(solver.eigenvalues().cwiseMax(0.0)))};
}

void MultiBody::SetPositions(const Eigen::Ref<const Eigen::VectorXd>& position) noexcept {
  for (std::size_t i = 0; i < coordinates.size(); ++i) {
    const arm::Coordinate& at = coordinates[i];
    if (at.joint < 0) continue;
    body->setJointPos(static_cast<int>(i), at.multiplier * position[at.joint] + at.offset);
  }
}

void MultiBody::SetVelocities(const Eigen::Ref<const Eigen::VectorXd>& velocity) noexcept {
  for (std::size_t i = 0; i < coordinates.size(); ++i) {
    const arm::Coordinate& at = coordinates[i];
    if (at.joint < 0) continue;
    body->setJointVel(static_cast<int>(i), at.multiplier * velocity[at.joint]);
  }
}

void MultiBody::Accelerate() noexcept {
  // Bullet adds dt x acceleration to the velocities: with dt = 1 the difference is the
  // acceleration.
  const Eigen::Map<const Eigen::VectorXd> velocity(body->getVelocityVector(), force.size());
  force = velocity;
  body->computeAccelerationsArticulatedBodyAlgorithmMultiDof(1.0, scratch_r, scratch_v, scratch_m,
                                                             false, false, false);
  response = velocity - force;
  body->setBaseOmega({force[0], force[1], force[2]});
  body->setBaseVel({force[3], force[4], force[5]});
  for (int i = 0; i < body->getNumLinks(); ++i) {
    if (body->getLink(i).m_dofCount > 0) body->setJointVel(i, force[EntryOf(i)]);
  }
  for (Eigen::Index row = 0; row < C.rows(); ++row) {
    force = C.row(row).transpose();
    body->calcAccelerationDeltasMultiDof(force.data(), a_ct.col(row).data(), scratch_r, scratch_v);
  }
  force.setZero();
  if (C.rows() == 0) return;
  c_a_ct.noalias() = C * a_ct;
  factor.compute(c_a_ct);
  Couple();
}

void MultiBody::Respond() noexcept {
  body->calcAccelerationDeltasMultiDof(force.data(), response.data(), scratch_r, scratch_v);
  if (C.rows() > 0) Couple();
}

void MultiBody::Couple() noexcept {
  coupling.noalias() = C * response;
  factor.solveInPlace(coupling);
  response.noalias() -= a_ct * coupling;
}

MultiBody MakeMultiBody(const arm::Chain& chain, const Eigen::Vector3d& gravity_m_s2,
                        bool fixed_base) {
  MultiBody out;
  const int count = static_cast<int>(chain.bodies.size());
  if (!fixed_base) out.base = PrincipalOf(chain.base.com_m, chain.base.inertia_kg_m2);
  const btVector3 base_moments = fixed_base ? btVector3(1.0, 1.0, 1.0) : out.base.moments;
  out.body = std::make_unique<btMultiBody>(count, fixed_base ? 1.0 : chain.base.mass_kg,
                                           base_moments, fixed_base, /*canSleep=*/false);
  btMultiBody& multi = *out.body;
  std::vector<Principal> principal;
  for (int i = 0; i < count; ++i) {
    const arm::Body& body = chain.bodies[static_cast<std::size_t>(i)];
    principal.push_back(PrincipalOf(body.com_m, body.inertia_kg_m2));
    const btTransform parent_frame =
        body.parent < 0 ? out.base.frame : principal[static_cast<std::size_t>(body.parent)].frame;
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
    if (arm::IsFree(body)) out.joint_bodies.push_back(i);
    const Eigen::Vector3d weight =
        body.weightless ? Eigen::Vector3d::Zero().eval() : (body.mass_kg * gravity_m_s2).eval();
    out.weight_N.push_back(ToBullet(weight));
  }
  multi.finalizeMultiDof();
  out.coordinates = arm::CoordinatesOf(chain);
  out.force = out.response = Eigen::VectorXd::Zero(6 + multi.getNumDofs());
  const auto joints = static_cast<int>(out.joint_bodies.size());
  out.C = Eigen::MatrixXd::Zero(multi.getNumDofs() - joints, out.force.size());
  out.a_ct = out.C.transpose();
  out.c_a_ct.resize(out.C.rows(), out.C.rows());
  for (int i = 0, row = 0; i < count; ++i) {
    const arm::Coordinate& at = out.coordinates[static_cast<std::size_t>(i)];
    if (at.joint < 0 || at.body == i) continue;
    out.C(row, out.EntryOf(i)) = 1.0;
    out.C(row++, out.EntryOf(at.body)) = -at.multiplier;
  }
  multi.setHasSelfCollision(false);
  multi.setLinearDamping(0.0);
  multi.setAngularDamping(0.0);
  multi.setUseGyroTerm(true);
  multi.setMaxAppliedImpulse(kUnlimited);
  multi.setMaxCoordinateVelocity(kUnlimited);
  return out;
}

}  // namespace sinew::world
