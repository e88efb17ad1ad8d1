// Constants of angles.
#pragma once

#include <numbers>

namespace sinew::types {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kTwoPi = 2.0 * std::numbers::pi;         // rad per turn
inline constexpr double kDegree_rad = std::numbers::pi / 180.0;  // rad per degree

}  // namespace sinew::types
