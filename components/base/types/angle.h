// Constants of angles; the tilt of a body.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace sinew::types {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kTwoPi = 2.0 * std::numbers::pi;         // rad per turn
inline constexpr double kDegree_rad = std::numbers::pi / 180.0;  // rad per degree

// Angle between the z axes of a body and of the world, rad, 0 to pi, from the unit quaternion (w,
// x, y, z) that takes the body's axes to the world's.
inline double Tilt(const std::array<double, 4>& wxyz) noexcept {
  const double up = 1.0 - 2.0 * (wxyz[1] * wxyz[1] + wxyz[2] * wxyz[2]);
  return std::acos(std::clamp(up, -1.0, 1.0));
}

}  // namespace sinew::types
