#include "components/bodies/leg/kinematics.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sinew::leg {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kOrthonormal = 1e-6;
// Below this, lengths (m) and cosines are rounding.
constexpr double kRounding = 1e-12;

Matrix3d Turn(double angle_rad, const Vector3d& axis) noexcept {
  return Eigen::AngleAxisd(angle_rad, axis).toRotationMatrix();
}

double Wrapped(double angle_rad) noexcept {
  return std::remainder(angle_rad, 2.0 * std::numbers::pi);
}

bool IsRotation(const Matrix3d& r) noexcept {
  return r.allFinite() &&
         (r.transpose() * r - Matrix3d::Identity()).cwiseAbs().maxCoeff() < kOrthonormal &&
         r.determinant() > 0.0;
}

}  // namespace

Eigen::Isometry3d Forward(const LegGeometry& geometry, const LegAngles& q) noexcept {
  const Matrix3d hip = Turn(q[kHipYaw], Vector3d::UnitZ()) * Turn(q[kHipRoll], Vector3d::UnitX());
  const double knee_from_vertical = q[kHipPitch] + q[kKnee];
  const double pitch = knee_from_vertical + q[kAnklePitch];
  const auto below = [](double length_m, double angle_rad) -> Vector3d {
    return {-length_m * std::sin(angle_rad), 0.0, -length_m * std::cos(angle_rad)};
  };
  const Vector3d planar = below(geometry.thigh_m, q[kHipPitch]) +
                          below(geometry.shank_m, knee_from_vertical) +
                          below(geometry.ankle_offset_m, pitch);
  Eigen::Isometry3d pelvis_from_sole = Eigen::Isometry3d::Identity();
  pelvis_from_sole.linear() =
      hip * Turn(pitch, Vector3d::UnitY()) * Turn(q[kAnkleRoll], Vector3d::UnitX());
  pelvis_from_sole.translation() = geometry.hip_in_pelvis_m + hip * planar +
                                   pelvis_from_sole.linear() * geometry.sole_in_ankle_m;
  return pelvis_from_sole;
}

LegSolution Inverse(const LegGeometry& geometry,
                    const Eigen::Isometry3d& pelvis_from_sole) noexcept {
  LegSolution out;
  const Matrix3d r_sole = pelvis_from_sole.linear();
  if (!IsRotation(r_sole) || !pelvis_from_sole.translation().allFinite()) return out;
  const Vector3d d =
      pelvis_from_sole.translation() - geometry.hip_in_pelvis_m - r_sole * geometry.sole_in_ankle_m;
  const Vector3d r = r_sole.transpose() * d;
  if (std::hypot(r.y(), r.z()) < kRounding) return out;
  const double ankle_roll = std::atan2(-r.y(), -r.z());

  const Matrix3d m = r_sole * Turn(-ankle_roll, Vector3d::UnitX());
  const double cos_roll = std::hypot(m(0, 1), m(1, 1));
  if (cos_roll < kRounding) return out;
  const double roll = std::atan2(m(2, 1), cos_roll);
  const double yaw = std::atan2(-m(0, 1), m(1, 1));
  const double pitch = std::atan2(-m(2, 0), m(2, 2));

  const Matrix3d hip = Turn(yaw, Vector3d::UnitZ()) * Turn(roll, Vector3d::UnitX());
  const Vector3d c = hip.transpose() * (d + geometry.ankle_offset_m * m.col(2));
  const double distance = std::hypot(c.x(), c.z());
  const double longest = geometry.thigh_m + geometry.shank_m;
  const double shortest = std::abs(geometry.thigh_m - geometry.shank_m);
  if (distance < kRounding) return out;  // the direction of the folded leg is not defined
  out.reach = Reach::kReached;
  if (distance > longest + kRounding) {
    out.reach = Reach::kTooFar;
    out.miss_m = distance - longest;
  } else if (distance < shortest - kRounding) {
    out.reach = Reach::kTooNear;
    out.miss_m = shortest - distance;
  }
  const double knee =
      2.0 * std::atan2(std::sqrt(std::max(0.0, (longest - distance) * (longest + distance))),
                       std::sqrt(std::max(0.0, (distance - shortest) * (distance + shortest))));
  const double hip_pitch =
      std::atan2(-c.x(), -c.z()) - std::atan2(geometry.shank_m * std::sin(knee),
                                              geometry.thigh_m + geometry.shank_m * std::cos(knee));
  out.q[kHipYaw] = yaw;
  out.q[kHipRoll] = roll;
  out.q[kHipPitch] = Wrapped(hip_pitch);
  out.q[kKnee] = knee;
  out.q[kAnklePitch] = Wrapped(pitch - hip_pitch - knee);
  out.q[kAnkleRoll] = ankle_roll;
  return out;
}

}  // namespace sinew::leg
