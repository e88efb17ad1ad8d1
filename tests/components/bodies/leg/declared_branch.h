// Where the inverse kinematics gives the angles of the forward one back.
#pragma once

#include <cmath>
#include <numbers>

#include "components/bodies/leg/kinematics.h"

namespace sinew::leg {

// Condition (4) of kinematics.h, and the ranges of knee and hip roll.
inline bool InDeclaredBranch(const LegGeometry& geometry, const LegAngles& q) {
  return q[kKnee] >= 0.0 && q[kKnee] <= std::numbers::pi &&
         std::abs(q[kHipRoll]) < 0.5 * std::numbers::pi &&
         geometry.ankle_offset_m + geometry.shank_m * std::cos(q[kAnklePitch]) +
                 geometry.thigh_m * std::cos(q[kKnee] + q[kAnklePitch]) >
             0.0;
}

}  // namespace sinew::leg
