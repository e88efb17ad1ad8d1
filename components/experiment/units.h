// Angles of this module's files.
#pragma once

#include <numbers>

namespace sinew::experiment {

inline constexpr double kTwoPi = 2.0 * std::numbers::pi;
inline constexpr double kDegree = std::numbers::pi / 180.0;

}  // namespace sinew::experiment
