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
    if (body.moves) out.joint_bodies.push_back(i);
    const Eigen::Vector3d weight =
        body.weightless ? Eigen::Vector3d::Zero().eval() : (body.mass_kg * gravity_m_s2).eval();
    out.weight_N.push_back(ToBullet(weight));
  }
  multi.finalizeMultiDof();
  multi.setHasSelfCollision(false);
  multi.setLinearDamping(0.0);
  multi.setAngularDamping(0.0);
  multi.setUseGyroTerm(true);
  multi.setMaxAppliedImpulse(kUnlimited);
  multi.setMaxCoordinateVelocity(kUnlimited);
  return out;
}

}  // namespace sinew::world
