#include "sim/world/floating_chain.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <stdexcept>
#include <string>

#include "sim/world/multi_body.h"

namespace sinew::world {

namespace {

// Bodies are triangular to rounding of decimal input, as in urdf_file.cc.
constexpr double kTriangleSlack = 1e-3;

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

// [v] w = v x w.
Eigen::Matrix3d CrossMatrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d out;
  out << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return out;
}

// Spatial inertia (moment, force) = I (angular, linear) about the origin, of a body whose `linear`
// inertia acts at `at` and which has `about` of its own: for a body mass 1 at the centre of mass.
Matrix6 SpatialInertia(const Eigen::Vector3d& linear, const Eigen::Vector3d& at,
                       const Eigen::Matrix3d& about) {
  const Eigen::Matrix3d cross = CrossMatrix(at);
  const Eigen::Matrix3d lever = cross * linear.asDiagonal();
  Matrix6 out;
  out.topLeftCorner<3, 3>().noalias() = about - lever * cross;
  out.topRightCorner<3, 3>() = lever;
  out.bottomLeftCorner<3, 3>() = lever.transpose();
  out.bottomRightCorner<3, 3>() = linear.asDiagonal();
  return out;
}

void CheckBase(const arm::Base& base) {
  const std::string name = "base link '" + base.link_name + "'";
  if (!(base.mass_kg > 0.0) || !std::isfinite(base.mass_kg)) {
    throw std::invalid_argument(name + ": mass " + std::to_string(base.mass_kg) +
                                ", expected kg above 0 for a floating base");
  }
  if (!base.com_m.allFinite() || !base.inertia_kg_m2.allFinite()) {
    throw std::invalid_argument(name + ": centre of mass or inertia is not finite");
  }
  const Eigen::Vector3d moments =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(base.inertia_kg_m2).eigenvalues();
  if (!(moments[0] > 0.0)) {
    throw std::invalid_argument(name + ": inertia has the principal moment " +
                                std::to_string(moments[0]) + ", expected all above 0");
  }
  if (moments[0] + moments[1] < moments[2] * (1.0 - kTriangleSlack)) {
    throw std::invalid_argument(name +
                                ": inertia breaks the triangle inequality: no body has these "
                                "moments");
  }
}

}  // namespace

void Drift(double time_s, FloatingState* state) noexcept {
  const Eigen::Vector3d half = 0.5 * time_s * state->velocity.head<3>();
  const double angle = half.norm();
  // sin(x)/x; the series' next term is below rounding at the limit: x^4/120 < 1e-18.
  const double ratio = angle < 1e-4 ? 1.0 - angle * angle / 6.0 : std::sin(angle) / angle;
  Eigen::Quaterniond turn;
  turn.w() = std::cos(angle);
  turn.vec() = ratio * half;
  state->orientation = turn * state->orientation;
  state->orientation.normalize();
  state->position_m += time_s * state->velocity.segment<3>(3);
  const Eigen::Index joints = state->joint_position_rad.size();
  state->joint_position_rad += time_s * state->velocity.tail(joints);
}

struct FloatingChain::Impl {
  // A link in the world; its own arrays, as Bullet keeps none of the links' origins.
  struct Link {
    Eigen::Matrix3d rotation;  // link to world
    Eigen::Vector3d origin, com;
    Eigen::Vector3d angular, linear;  // of the origin
    // Motion of its joint: (angular, linear) velocity of the base link's origin, carried along, for
    // a unit of the joint's.
    Vector6 motion = Vector6::Zero();
  };
  struct Constants {
    int parent = kBaseBody;
    arm::Coordinate coordinate;
    bool prismatic = false, weightless = false;
    Eigen::Isometry3d parent_from_joint;
    Eigen::Vector3d axis, com;
    double mass = 0.0;
    Eigen::Matrix3d inertia;
  };

  MultiBody multi;
  Eigen::Vector3d gravity, base_weight_N;
  double mass = 0.0;
  std::vector<Constants> constants;  // base first
  std::vector<Link> links;           // base first
  Eigen::VectorXd nu;                // of the last SetState
  std::vector<int> parents;          // FloatingChain::parents
  std::vector<Matrix6> composite;    // work space of Inertia, base first

  const Link& link(int body) const { return links[static_cast<std::size_t>(body + 1)]; }
  Eigen::Vector3d base_lever() const { return links.front().com - links.front().origin; }
  Eigen::Vector3d ComVelocity(std::size_t i) const {
    return links[i].linear + links[i].angular.cross(links[i].com - links[i].origin);
  }
  void CopyResponse(Eigen::Ref<Eigen::VectorXd> to) noexcept {
    to.head<kBaseFreedom>() = multi.response.head<kBaseFreedom>();
    for (std::size_t j = 0; j < multi.joint_bodies.size(); ++j) {
      to[kBaseFreedom + static_cast<Eigen::Index>(j)] = multi.response[multi.Entry(j)];
    }
  }
  // Bullet's base velocity is that of the centre of mass.
  void SetVelocity() noexcept {
    const Eigen::Vector3d angular = nu.head<3>();
    const Eigen::Vector3d linear = nu.segment<3>(3) + angular.cross(base_lever());
    multi.body->setBaseOmega(ToBullet(angular));
    multi.body->setBaseVel(ToBullet(linear));
    multi.SetVelocities(nu.tail(nu.size() - kBaseFreedom));
  }
};

FloatingChain::FloatingChain(const arm::Chain& chain, const Eigen::Vector3d& gravity_m_s2)
    : impl_(std::make_unique<Impl>()) {
  CheckBase(chain.base);
  impl_->multi = MakeMultiBody(chain, gravity_m_s2, /*fixed_base=*/false);
  impl_->gravity = gravity_m_s2;
  impl_->base_weight_N = chain.base.mass_kg * gravity_m_s2;
  impl_->mass = chain.base.mass_kg;
  impl_->constants.push_back({.parent_from_joint = Eigen::Isometry3d::Identity(),
                              .axis = Eigen::Vector3d::UnitX(),
                              .com = chain.base.com_m,
                              .mass = chain.base.mass_kg,
                              .inertia = chain.base.inertia_kg_m2});
  for (std::size_t i = 0; i < chain.bodies.size(); ++i) {
    const arm::Body& body = chain.bodies[i];
    impl_->constants.push_back({.parent = body.parent,
                                .coordinate = impl_->multi.coordinates[i],
                                .prismatic = body.prismatic,
                                .weightless = body.weightless,
                                .parent_from_joint = body.parent_from_joint,
                                .axis = body.axis,
                                .com = body.com_m,
                                .mass = body.mass_kg,
                                .inertia = body.inertia_kg_m2});
    impl_->mass += body.mass_kg;
  }
  impl_->links.resize(impl_->constants.size());
  impl_->composite.resize(impl_->constants.size());
  for (int k = 0; k < kBaseFreedom; ++k) impl_->parents.push_back(k - 1);
  for (const Impl::Constants& body : impl_->constants) {
    if (body.coordinate.joint < 0) continue;
    if (&body - impl_->constants.data() - 1 != body.coordinate.body) continue;
    if (impl_->multi.C.rows() > 0) {  // joints of other branches share entries of H: one branch
      impl_->parents.push_back(static_cast<int>(impl_->parents.size()) - 1);
      continue;
    }
    const Impl::Constants* at = &impl_->constants[static_cast<std::size_t>(body.parent + 1)];
    while (at->coordinate.joint < 0 && at != impl_->constants.data()) {
      at = &impl_->constants[static_cast<std::size_t>(at->parent + 1)];
    }
    impl_->parents.push_back(kBaseFreedom + at->coordinate.joint);
  }
  impl_->nu = Eigen::VectorXd::Zero(freedom());
  SetState(Rest());
}

FloatingChain::~FloatingChain() = default;
FloatingChain::FloatingChain(FloatingChain&&) noexcept = default;
FloatingChain& FloatingChain::operator=(FloatingChain&&) noexcept = default;

int FloatingChain::joint_count() const {
  return static_cast<int>(impl_->multi.joint_bodies.size());
}
int FloatingChain::body_count() const { return static_cast<int>(impl_->constants.size()) - 1; }
const std::vector<int>& FloatingChain::joint_bodies() const { return impl_->multi.joint_bodies; }
const std::vector<int>& FloatingChain::parents() const { return impl_->parents; }
double FloatingChain::mass_kg() const { return impl_->mass; }
const Eigen::Vector3d& FloatingChain::gravity_m_s2() const { return impl_->gravity; }

FloatingState FloatingChain::Rest() const {
  FloatingState state;
  state.joint_position_rad = Eigen::VectorXd::Zero(joint_count());
  state.velocity = Eigen::VectorXd::Zero(freedom());
  return state;
}

void FloatingChain::SetState(const FloatingState& state) noexcept {
  Impl& impl = *impl_;
  impl.nu = state.velocity;
  for (std::size_t i = 0; i < impl.links.size(); ++i) {
    const Impl::Constants& fixed = impl.constants[i];
    Impl::Link& link = impl.links[i];
    if (i == 0) {
      link.rotation = state.orientation.toRotationMatrix();
      link.origin = state.position_m;
      link.angular = state.velocity.head<3>();
      link.linear = state.velocity.segment<3>(3);
    } else {
      const Impl::Link& parent = impl.links[static_cast<std::size_t>(fixed.parent + 1)];
      link.rotation.noalias() = parent.rotation * fixed.parent_from_joint.linear();
      link.origin = parent.origin + parent.rotation * fixed.parent_from_joint.translation();
      link.angular = parent.angular;
      const arm::Coordinate& by = fixed.coordinate;
      if (by.joint >= 0) {
        const double q = by.multiplier * state.joint_position_rad[by.joint] + by.offset;
        const double rate = by.multiplier * state.velocity[kBaseFreedom + by.joint];
        const Eigen::Vector3d axis = link.rotation * fixed.axis;
        if (fixed.prismatic) {
          link.origin += q * axis;
          link.motion.tail<3>() = axis;
        } else {
          link.motion << axis, (link.origin - state.position_m).cross(axis);
          const Eigen::Matrix3d turned =
              link.rotation * Eigen::AngleAxisd(q, fixed.axis).toRotationMatrix();
          link.rotation = turned;
          link.angular += rate * axis;
        }
        link.motion *= by.multiplier;
        link.linear = parent.linear + parent.angular.cross(link.origin - parent.origin);
        if (fixed.prismatic) link.linear += rate * axis;
      } else {
        link.linear = parent.linear + parent.angular.cross(link.origin - parent.origin);
      }
    }
    link.com = link.origin + link.rotation * fixed.com;
  }
  btMultiBody& multi = *impl.multi.body;
  const Eigen::Quaterniond& q = state.orientation;
  const btQuaternion principal_to_world =
      btQuaternion(q.x(), q.y(), q.z(), q.w()) * impl.multi.base.frame.getRotation();
  multi.setBasePos(ToBullet(impl.links.front().com));
  multi.setWorldToBaseRot(principal_to_world.inverse());
  impl.multi.SetPositions(state.joint_position_rad);
  impl.SetVelocity();
}

Eigen::Isometry3d FloatingChain::Pose(int body) const noexcept {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = impl_->link(body).rotation;
  pose.translation() = impl_->link(body).origin;
  return pose;
}

PointMotion FloatingChain::Point(int body, const Eigen::Vector3d& point_m) const noexcept {
  const Impl::Link& link = impl_->link(body);
  const Eigen::Vector3d arm = link.rotation * point_m;
  return {link.origin + arm, link.linear + link.angular.cross(arm)};
}

void FloatingChain::Jacobian(int body, const Eigen::Vector3d& point_m,
                             Eigen::Ref<Eigen::Matrix3Xd> jacobian) const noexcept {
  const Impl::Link& base = impl_->links.front();
  const Impl::Link& link = impl_->link(body);
  const Eigen::Vector3d arm = link.origin + link.rotation * point_m - base.origin;
  jacobian.setZero();
  jacobian.leftCols<3>() = CrossMatrix(-arm);
  jacobian.middleCols<3>(3).setIdentity();
  for (int at = body; at != kBaseBody;) {
    const Impl::Constants& fixed = impl_->constants[static_cast<std::size_t>(at + 1)];
    if (fixed.coordinate.joint >= 0) {
      const Vector6& motion = impl_->link(at).motion;
      jacobian.col(kBaseFreedom + fixed.coordinate.joint) +=
          motion.tail<3>() + motion.head<3>().cross(arm);
    }
    at = fixed.parent;
  }
}

void FloatingChain::Inertia(std::span<const PointInertia> added,
                            Eigen::Ref<Eigen::MatrixXd> inertia) noexcept {
  Impl& impl = *impl_;
  const Eigen::Vector3d origin = impl.links.front().origin;
  for (std::size_t i = 0; i < impl.links.size(); ++i) {
    const Impl::Link& link = impl.links[i];
    const Impl::Constants& fixed = impl.constants[i];
    const Eigen::Matrix3d about = link.rotation * fixed.inertia * link.rotation.transpose();
    impl.composite[i] =
        SpatialInertia(Eigen::Vector3d::Constant(fixed.mass), link.com - origin, about);
  }
  for (const PointInertia& at : added) {
    const Impl::Link& link = impl.link(at.body);
    impl.composite[static_cast<std::size_t>(at.body + 1)] += SpatialInertia(
        at.mass_kg, link.origin + link.rotation * at.point_m - origin, Eigen::Matrix3d::Zero());
  }
  inertia.setZero();
  for (std::size_t i = impl.links.size() - 1; i > 0; --i) {
    const Impl::Constants& fixed = impl.constants[i];
    impl.composite[static_cast<std::size_t>(fixed.parent + 1)] += impl.composite[i];
    if (fixed.coordinate.joint < 0) continue;
    const Vector6& motion = impl.links[i].motion;
    const Vector6 momentum = impl.composite[i] * motion;
    const int row = kBaseFreedom + fixed.coordinate.joint;
    inertia(row, row) += motion.dot(momentum);
    for (int body = fixed.parent; body != kBaseBody;) {
      const Impl::Constants& before = impl.constants[static_cast<std::size_t>(body + 1)];
      if (before.coordinate.joint >= 0) {
        const int column = kBaseFreedom + before.coordinate.joint;
        const double shared = impl.link(body).motion.dot(momentum);
        inertia(row, column) += shared;
        inertia(column, row) += shared;
      }
      body = before.parent;
    }
    inertia.col(row).head<6>() += momentum;
    inertia.row(row).head<6>() += momentum.transpose();
  }
  inertia.topLeftCorner<6, 6>() = impl.composite.front();
}

double FloatingChain::Energy() const noexcept {
  double energy = 0.0;
  for (std::size_t i = 0; i < impl_->links.size(); ++i) {
    const Impl::Link& link = impl_->links[i];
    const Impl::Constants& fixed = impl_->constants[i];
    const Eigen::Vector3d spin = link.rotation.transpose() * link.angular;
    energy += 0.5 * fixed.mass * impl_->ComVelocity(i).squaredNorm() +
              0.5 * spin.dot(fixed.inertia * spin);
    if (!fixed.weightless) energy -= fixed.mass * impl_->gravity.dot(link.com);
  }
  return energy;
}

Eigen::Vector3d FloatingChain::CenterOfMass() const noexcept {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < impl_->links.size(); ++i) {
    sum += impl_->constants[i].mass * impl_->links[i].com;
  }
  return sum / impl_->mass;
}

Eigen::Vector3d FloatingChain::AngularMomentum() const noexcept {
  const Eigen::Vector3d center = CenterOfMass();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < impl_->links.size(); ++i) {
    const Impl::Link& link = impl_->links[i];
    const Impl::Constants& fixed = impl_->constants[i];
    const Eigen::Vector3d spin = link.rotation.transpose() * link.angular;
    sum += link.rotation * (fixed.inertia * spin) +
           fixed.mass * (link.com - center).cross(impl_->ComVelocity(i));
  }
  return sum;
}

void FloatingChain::Solve(const Eigen::Ref<const Eigen::VectorXd>& torque_Nm,
                          std::span<const LinkForce> forces,
                          Eigen::Ref<Eigen::VectorXd> acceleration) noexcept {
  Impl& impl = *impl_;
  btMultiBody& multi = *impl.multi.body;
  multi.clearForcesAndTorques();
  multi.addBaseForce(ToBullet(impl.base_weight_N));
  for (int i = 0; i < multi.getNumLinks(); ++i) {
    multi.addLinkForce(i, impl.multi.weight_N[static_cast<std::size_t>(i)]);
  }
  for (const LinkForce& at : forces) {
    const Impl::Link& link = impl.link(at.body);
    const Eigen::Vector3d arm = link.origin + link.rotation * at.point_m - link.com;
    const btVector3 moment = ToBullet(Eigen::Vector3d(arm.cross(at.force_N)));
    if (at.body == kBaseBody) {
      multi.addBaseForce(ToBullet(at.force_N));
      multi.addBaseTorque(moment);
    } else {
      multi.addLinkForce(at.body, ToBullet(at.force_N));
      multi.addLinkTorque(at.body, moment);
    }
  }
  for (std::size_t j = 0; j < impl.multi.joint_bodies.size(); ++j) {
    multi.addJointTorque(impl.multi.joint_bodies[j], torque_Nm[static_cast<Eigen::Index>(j)]);
  }
  impl.multi.Accelerate();
  impl.CopyResponse(acceleration);
  const Eigen::Vector3d lever = impl.base_lever();
  const Eigen::Vector3d turning = acceleration.head<3>();
  const Eigen::Vector3d angular = impl.nu.head<3>();
  acceleration.segment<3>(3) -= turning.cross(lever) + angular.cross(angular.cross(lever));
}

void FloatingChain::Responses(Eigen::Ref<Eigen::MatrixXd> inverse_inertia) noexcept {
  Impl& impl = *impl_;
  const Eigen::Vector3d lever = impl.base_lever();
  Eigen::VectorXd& force = impl.multi.force;
  for (int column = 0; column < freedom(); ++column) {
    double& at = force[column < kBaseFreedom
                           ? column
                           : impl.multi.Entry(static_cast<std::size_t>(column - kBaseFreedom))];
    at = 1.0;
    Eigen::Vector3d shifted = Eigen::Vector3d::Zero();
    if (column >= 3 && column < kBaseFreedom) {
      // A force at the origin has a moment about the centre of mass.
      shifted = -lever.cross(Eigen::Vector3d::Unit(column - 3));
      force.head<3>() = shifted;
    }
    impl.multi.Respond();
    at = 0.0;
    force.head<3>().setZero();
    impl.CopyResponse(inverse_inertia.col(column));
    const Eigen::Vector3d turning = inverse_inertia.col(column).head<3>();
    inverse_inertia.col(column).segment<3>(3) -= turning.cross(lever);
  }
}

}  // namespace sinew::world
