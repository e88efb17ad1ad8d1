// The lengths of a leg (kinematics.h) from the bodies of a robot, and the refusal of legs of
// another kind.
//
// Set-up only. Thread: free functions. Allocates.
#pragma once

#include <array>
#include <string>

#include "components/bodies/leg/kinematics.h"
#include "components/bodies/links/bodies.h"

namespace sinew::leg {

using LegJointNames = std::array<std::string, kLegJoints>;  // in the order of LegJoint

// "left" -> "left_hip_yaw", "left_hip_roll", "left_hip_pitch", "left_knee", "left_ankle_pitch",
// "left_ankle_roll".
LegJointNames NamesOfSide(const std::string& side);

// The pelvis's frame is the root of the chain. sole_link is fixed to the link of the ankle roll,
// its frame parallel to it.
//
// Throws std::invalid_argument, naming joint or link and the value, when a joint or link is absent,
// does not turn, does not follow the one before (first: fixed to the root), when an axis is not
// z, x, y, y, y, x with all joints at 0 (to 1e-9), when the hip's axes do not meet in a point, when
// knee or ankle pitch are not straight below the hip, when the ankle roll axis does not cross the
// leg below the ankle pitch (to 1e-9 m), or when a length is not above 0 (the ankle's offset: not
// below 0).
LegGeometry GeometryOf(const arm::Chain& chain, const LegJointNames& names,
                       const std::string& sole_link);

}  // namespace sinew::leg
