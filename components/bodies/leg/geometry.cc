#include "components/bodies/leg/geometry.h"

#include <cmath>
#include <cstddef>
#include <sstream>
#include <stdexcept>

namespace sinew::leg {

namespace {

using Eigen::Vector3d;

constexpr double kParallel = 1e-9;
constexpr double kSamePoint_m = 1e-9;

const arm::Body& BodyAt(const arm::Chain& chain, int index) {
  return chain.bodies[static_cast<std::size_t>(index)];
}

std::string Written(const Vector3d& v) {
  std::ostringstream out;
  out << "(" << v.x() << ", " << v.y() << ", " << v.z() << ")";
  return out.str();
}

// With every joint at 0.
Eigen::Isometry3d FrameInRoot(const arm::Chain& chain, int body) {
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  for (; body >= 0; body = BodyAt(chain, body).parent) {
    frame = BodyAt(chain, body).parent_from_joint * frame;
  }
  return frame;
}

// The next moving body towards the root, or -1.
int MovingParent(const arm::Chain& chain, int body) {
  int parent = BodyAt(chain, body).parent;
  while (parent >= 0 && !BodyAt(chain, parent).moves) parent = BodyAt(chain, parent).parent;
  return parent;
}

struct AxisLine {
  Vector3d point;
  Vector3d direction;
};

void RequireSame(double value_m, double expected_m, const std::string& what) {
  if (std::abs(value_m - expected_m) <= kSamePoint_m) return;
  std::ostringstream message;
  message << what << " by " << value_m - expected_m << " m";
  throw std::invalid_argument(message.str());
}

double RequireAbove(double length_m, bool zero_allowed, const std::string& what) {
  if (length_m > 0.0 || (zero_allowed && length_m > -kSamePoint_m)) {
    return zero_allowed && length_m < 0.0 ? 0.0 : length_m;
  }
  std::ostringstream message;
  message << what << " is " << length_m << " m, expected it above 0";
  throw std::invalid_argument(message.str());
}

}  // namespace

LegJointNames NamesOfSide(const std::string& side) {
  return {side + "_hip_yaw", side + "_hip_roll",    side + "_hip_pitch",
          side + "_knee",    side + "_ankle_pitch", side + "_ankle_roll"};
}

LegGeometry GeometryOf(const arm::Chain& chain, const LegJointNames& names,
                       const std::string& sole_link) {
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  const std::array<Vector3d, kLegJoints> expected = {z, x, y, y, y, x};
  std::array<AxisLine, kLegJoints> axes;
  int before = -1;
  for (std::size_t j = 0; j < names.size(); ++j) {
    const std::string joint = "joint '" + names[j] + "'";
    const int index = arm::FindJoint(chain, names[j]);
    if (index < 0) throw std::invalid_argument(joint + ": no moving joint of this name");
    const arm::Body& body = BodyAt(chain, index);
    if (body.prismatic) throw std::invalid_argument(joint + " is prismatic, expected revolute");
    if (MovingParent(chain, index) != before) {
      throw std::invalid_argument(joint + " does not follow " +
                                  (j == 0 ? "the root" : "joint '" + names[j - 1] + "'"));
    }
    const Eigen::Isometry3d frame = FrameInRoot(chain, index);
    axes[j] = {frame.translation(), frame.linear() * body.axis};
    if (!((axes[j].direction - expected[j]).norm() <= kParallel)) {
      throw std::invalid_argument(joint + " turns about " + Written(axes[j].direction) +
                                  " of the root, expected " + Written(expected[j]));
    }
    before = index;
  }

  const auto quoted = [&names](LegJoint joint) {
    return "joint '" + names[static_cast<std::size_t>(joint)] + "'";
  };
  const Vector3d hip(axes[kHipYaw].point.x(), axes[kHipYaw].point.y(), axes[kHipRoll].point.z());
  const std::string misses = ": its axis misses the hip centre, where the axes meet,";
  RequireSame(axes[kHipRoll].point.y(), hip.y(), quoted(kHipRoll) + misses + " in y");
  RequireSame(axes[kHipPitch].point.x(), hip.x(), quoted(kHipPitch) + misses + " in x");
  RequireSame(axes[kHipPitch].point.z(), hip.z(), quoted(kHipPitch) + misses + " in z");
  const std::string beside = ": its axis is not straight below the hip: off in x";
  RequireSame(axes[kKnee].point.x(), hip.x(), quoted(kKnee) + beside);
  RequireSame(axes[kAnklePitch].point.x(), hip.x(), quoted(kAnklePitch) + beside);
  RequireSame(axes[kAnkleRoll].point.y(), hip.y(),
              quoted(kAnkleRoll) + ": its axis does not cross the leg: off in y");

  LegGeometry geometry;
  geometry.hip_in_pelvis_m = hip;
  const auto below = [&](double upper_m, LegJoint joint, bool zero_allowed) {
    return RequireAbove(upper_m - axes[static_cast<std::size_t>(joint)].point.z(), zero_allowed,
                        quoted(joint) + ": its distance below the axis before");
  };
  geometry.thigh_m = below(hip.z(), kKnee, false);
  geometry.shank_m = below(axes[kKnee].point.z(), kAnklePitch, false);
  geometry.ankle_offset_m = below(axes[kAnklePitch].point.z(), kAnkleRoll, true);

  int sole = -1;
  for (int i = 0; i < static_cast<int>(chain.bodies.size()); ++i) {
    if (BodyAt(chain, i).link_name == sole_link) sole = i;
  }
  if (sole < 0) throw std::invalid_argument("link '" + sole_link + "': no link of this name");
  if (BodyAt(chain, sole).moves || MovingParent(chain, sole) != before) {
    throw std::invalid_argument("link '" + sole_link + "' is not fixed to the link of " +
                                quoted(kAnkleRoll));
  }
  const Eigen::Isometry3d frame = FrameInRoot(chain, sole);
  if (!((frame.linear() - Eigen::Matrix3d::Identity()).norm() <= kParallel)) {
    throw std::invalid_argument("link '" + sole_link +
                                "': its frame is not parallel to the root's");
  }
  geometry.sole_in_ankle_m =
      frame.translation() - Vector3d(hip.x(), hip.y(), axes[kAnkleRoll].point.z());
  return geometry;
}

}  // namespace sinew::leg
