#include "components/bodies/stance/double_support.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace sinew::stance {

namespace {

// Points closer to a line than this, m, do not bear a sole.
constexpr double kNarrowestSole_m = 1e-3;
// Mean of the two normals, relative to a unit vector: soles face each other.
constexpr double kFacing = 1e-6;

// G of (3); shares it with the check of a sole's points.
Eigen::Matrix3d Spread(const Eigen::Vector3d& d) {
  return d.squaredNorm() * Eigen::Matrix3d::Identity() - d * d.transpose();
}

Eigen::Vector3d CheckedGravity(double gravity_m_s2) {
  if (!(gravity_m_s2 > 0.0) || !std::isfinite(gravity_m_s2)) {
    throw std::invalid_argument("gravity " + std::to_string(gravity_m_s2) +
                                ", expected m/s^2 above 0");
  }
  return {0.0, 0.0, -gravity_m_s2};
}

}  // namespace

SoleConfig SoleOfSide(const std::string& side) {
  SoleConfig sole{.frame = side + "_sole", .points = {}};
  for (const char* name : {"rear_outer", "rear_inner", "front_outer", "front_inner"}) {
    sole.points.push_back(side + "_force_" + name);
  }
  return sole;
}

DoubleSupport::DoubleSupport(const arm::Chain& chain, const DoubleSupportConfig& config)
    : dynamics_(chain, CheckedGravity(config.gravity_m_s2)), links_(arm::MovingLinksOf(chain)) {
  in_base_.resize(links_.links.size() + 1);
  for (std::size_t i = 0; i < links_.links.size(); ++i) {
    in_base_[i + 1].axis = links_.links[i].axis;
  }
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(joints());
  Kinematics(zero, zero, zero);
  for (std::size_t s = 0; s < kSoles; ++s) {
    const SoleConfig& sole = config.soles[s];
    soles_[s] = Find(chain, sole.frame);
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    std::vector<Eigen::Vector3d> places;
    for (const std::string& name : sole.points) {
      points_.push_back({static_cast<int>(s), Find(chain, name)});
      const arm::Carried& on = points_.back().on;
      places.push_back(Fixed(LinkOf(on.link), on.link_from_body).p);
      mean += places.back() / static_cast<double>(sole.points.size());
      result_.points.push_back({.sole = static_cast<int>(s), .name = name});
    }
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const Eigen::Vector3d& place : places) spread += Spread(place - mean);
    // The least moment is that about the line nearest to the points.
    const double narrow =
        places.empty()
            ? 0.0
            : Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvalues().minCoeff();
    if (places.size() < 3 || narrow < kNarrowestSole_m * kNarrowestSole_m) {
      throw std::invalid_argument("sole '" + sole.frame + "' has " + std::to_string(places.size()) +
                                  " points, expected three or more that are not on a line");
    }
  }
  force_.resize(dynamics_.freedom());
  result_.motion = dynamics_.Rest();
  result_.torque = zero;
}

arm::Carried DoubleSupport::Find(const arm::Chain& chain, const std::string& link) const {
  for (std::size_t i = 0; i < chain.bodies.size(); ++i) {
    if (chain.bodies[i].link_name == link) return links_.bodies[i];
  }
  throw std::invalid_argument("robot '" + chain.name + "' has no link '" + link + "'");
}

DoubleSupport::InBase DoubleSupport::Fixed(const InBase& to, const Eigen::Isometry3d& at) noexcept {
  const Eigen::Vector3d arm = to.R * at.translation();
  InBase out;
  out.R = to.R * at.linear();
  out.p = to.p + arm;
  out.w = to.w;
  out.dw = to.dw;
  out.v = to.v + to.w.cross(arm);
  out.a = to.a + to.dw.cross(arm) + to.w.cross(to.w.cross(arm));
  return out;
}

void DoubleSupport::Kinematics(const Eigen::Ref<const Eigen::VectorXd>& q,
                               const Eigen::Ref<const Eigen::VectorXd>& v,
                               const Eigen::Ref<const Eigen::VectorXd>& a) noexcept {
  for (std::size_t i = 0; i < links_.links.size(); ++i) {
    const arm::MovingLink& link = links_.links[i];
    const auto k = static_cast<Eigen::Index>(i);
    InBase here = Fixed(LinkOf(link.parent), link.parent_from_joint);
    here.axis = here.R * link.axis;
    const Eigen::Vector3d rate = v[k] * here.axis;
    if (link.prismatic) {
      const Eigen::Vector3d way = q[k] * here.axis;
      here.p += way;
      here.v += here.w.cross(way) + rate;
      here.a += here.dw.cross(way) + here.w.cross(here.w.cross(way)) + 2.0 * here.w.cross(rate) +
                a[k] * here.axis;
    } else {
      here.R = here.R * Eigen::AngleAxisd(q[k], link.axis).toRotationMatrix();
      here.dw += a[k] * here.axis + here.w.cross(rate);
      here.w += rate;
    }
    in_base_[i + 1] = here;
  }
}

bool DoubleSupport::SolveBase() noexcept {
  // Motion of the base by each sole alone, (1).
  std::array<Eigen::Vector3d, kSoles> up, w, v, dw, a;
  for (std::size_t s = 0; s < kSoles; ++s) {
    sole_in_base_[s] = Fixed(LinkOf(soles_[s].link), soles_[s].link_from_body);
    const InBase& sole = sole_in_base_[s];
    up[s] = sole.R.col(2);
    w[s] = -sole.w;
    v[s] = -sole.v - w[s].cross(sole.p);
    dw[s] = -sole.dw;
    a[s] =
        -sole.a - dw[s].cross(sole.p) - w[s].cross(w[s].cross(sole.p)) - 2.0 * w[s].cross(sole.v);
  }
  const Eigen::Vector3d mean_up = 0.5 * (up[0] + up[1]);
  if (!(mean_up.norm() > kFacing)) return false;
  const Eigen::Vector3d vertical = mean_up.normalized();
  // The turn of the base without a heading: its x axis stays in the world's xz plane. Pitch of 90
  // degrees has none.
  Eigen::Vector3d forward = Eigen::Vector3d::UnitX() - vertical.x() * vertical;
  if (!(forward.norm() > kFacing)) return false;
  forward.normalize();
  Eigen::Matrix3d base_to_world;
  base_to_world.row(0) = forward;
  base_to_world.row(1) = vertical.cross(forward);
  base_to_world.row(2) = vertical;
  arm::FloatingMotion& motion = result_.motion;
  motion.orientation = Eigen::Quaterniond(base_to_world);
  motion.velocity.head<3>() = base_to_world * (0.5 * (w[0] + w[1]));
  motion.velocity.segment<3>(3) = base_to_world * (0.5 * (v[0] + v[1]));
  motion.acceleration.head<3>() = base_to_world * (0.5 * (dw[0] + dw[1]));
  motion.acceleration.segment<3>(3) = base_to_world * (0.5 * (a[0] + a[1]));
  StanceMismatch& mismatch = result_.mismatch;
  mismatch.tilt_rad = std::atan2(up[0].cross(up[1]).norm(), up[0].dot(up[1]));
  mismatch.height_m = vertical.dot(sole_in_base_[0].p - sole_in_base_[1].p);
  mismatch.angular_velocity_rad_s = (w[0] - w[1]).norm();
  mismatch.velocity_m_s = (v[0] - v[1]).norm();
  mismatch.angular_acceleration_rad_s2 = (dw[0] - dw[1]).norm();
  mismatch.acceleration_m_s2 = (a[0] - a[1]).norm();
  return true;
}

void DoubleSupport::Distribute() noexcept {
  const Eigen::Matrix3d rotation = result_.motion.orientation.toRotationMatrix();
  const auto count = static_cast<double>(points_.size());
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < points_.size(); ++k) {
    const arm::Carried& on = points_[k].on;
    StancePoint& point = result_.points[k];
    point.place_m = rotation * Fixed(LinkOf(on.link), on.link_from_body).p;
    center += point.place_m / count;
  }
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const StancePoint& point : result_.points) spread += Spread(point.place_m - center);
  const Eigen::Vector3d moment = force_.head<3>(), force = force_.segment<3>(3);
  const Eigen::Vector3d turn = spread.llt().solve(moment - center.cross(force));
  result_.torque = force_.tail(joints());
  result_.soles = {};
  result_.least_normal_N = HUGE_VAL;
  for (std::size_t k = 0; k < points_.size(); ++k) {
    StancePoint& point = result_.points[k];
    point.force_N = force / count + turn.cross(point.place_m - center);
    result_.least_normal_N = std::min(result_.least_normal_N, point.force_N.z());
    const Eigen::Vector3d in_base = rotation.transpose() * point.force_N;
    const Eigen::Vector3d at = rotation.transpose() * point.place_m;
    for (int i = points_[k].on.link; i >= 0; i = links_.links[static_cast<std::size_t>(i)].parent) {
      const InBase& link = LinkOf(i);
      const bool prismatic = links_.links[static_cast<std::size_t>(i)].prismatic;
      result_.torque[i] -=
          prismatic ? link.axis.dot(in_base) : link.axis.dot((at - link.p).cross(in_base));
    }
    const auto s = static_cast<std::size_t>(point.sole);
    const InBase& sole = sole_in_base_[s];
    result_.soles[s].force_N += sole.R.transpose() * in_base;
    result_.soles[s].moment_Nm += sole.R.transpose() * (at - sole.p).cross(in_base);
  }
}

void DoubleSupport::Clear() noexcept {
  result_.ok = false;
  result_.motion.orientation.setIdentity();
  result_.motion.joint_position_rad.setZero();
  result_.motion.velocity.setZero();
  result_.motion.acceleration.setZero();
  result_.torque.setZero();
  result_.soles = {};
  for (StancePoint& point : result_.points) {
    point.place_m.setZero();
    point.force_N.setZero();
  }
  result_.least_normal_N = 0.0;
  result_.mismatch = {};
}

const DoubleSupportSolution& DoubleSupport::Solve(
    const Eigen::Ref<const Eigen::VectorXd>& q, const Eigen::Ref<const Eigen::VectorXd>& v,
    const Eigen::Ref<const Eigen::VectorXd>& a) noexcept {
  Clear();
  if (!q.allFinite() || !v.allFinite() || !a.allFinite()) return result_;
  Kinematics(q, v, a);
  if (!SolveBase()) {
    Clear();
    return result_;
  }
  arm::FloatingMotion& motion = result_.motion;
  motion.joint_position_rad = q;
  motion.velocity.tail(joints()) = v;
  motion.acceleration.tail(joints()) = a;
  dynamics_.Force(motion, dynamics_.nominal(), force_);
  Distribute();
  result_.ok = result_.torque.allFinite();
  if (!result_.ok) Clear();
  return result_;
}

}  // namespace sinew::stance
