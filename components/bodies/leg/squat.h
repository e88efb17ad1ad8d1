// Joint angles of a squat, with exact velocities and accelerations: the torso upright, the sole
// flat, yaw and rolls 0. Then the ankle pitch axis is straight below the ankle's offset and what is
// left is the planar chain of README.md, with the ankle (x, -h) from the hip, x constant:
//
//     u = D^2 = x^2 + h^2,   k = cos knee = (u - a^2 - b^2) / (2 a b)        a thigh, b shank
//     knee' = -k' / sin knee,        knee'' = -(k'' + k knee'^2) / sin knee
//     hip pitch = atan2(-x, h) - gamma,   gamma = atan2(b sin knee, a + b cos knee)
//     gamma' = g knee',   gamma'' = g knee'' + dg knee'^2
//     g = (b^2 + a b cos knee) / u,   dg = a b sin knee (b^2 - a^2) / u^2
//     ankle pitch = -hip pitch - knee
//
// sin knee is 0 in the straight and in the folded leg, where the joints' velocities are unbounded:
// both are refused. SI units. Pure; allocates nothing; any thread.
#pragma once

#include <optional>

#include "components/bodies/leg/kinematics.h"

namespace sinew::leg {

// Motion of the hip centre above the ankle pitch axis.
struct HipHeight {
  double height_m = 0.0;
  double velocity_m_s = 0.0;  // upwards
  double acceleration_m_s2 = 0.0;
};

struct JointMotion {
  double position_rad = 0.0;
  double velocity_rad_s = 0.0;
  double acceleration_rad_s2 = 0.0;
};

struct SquatMotion {
  JointMotion hip_pitch, knee, ankle_pitch;
};

// Height of the hip above the ankle pitch axis with a straight leg, foot_forward_m the ankle's
// place in front of the hip; 0 when the leg does not reach so far forward.
double StraightHeight(const LegGeometry& geometry, double foot_forward_m) noexcept;

// Nothing where the leg is straight, folded or does not reach, and for input that is not finite.
std::optional<SquatMotion> SquatAt(const LegGeometry& geometry, double foot_forward_m,
                                   const HipHeight& hip) noexcept;

}  // namespace sinew::leg
