// Numbers of the rig that many tests use.
#pragma once

#include <numbers>

namespace sinew {

inline constexpr double kCount_rad =
    2.0 * std::numbers::pi / 16384.0;                        // a count of a 14-bit encoder
inline constexpr double kDegree = std::numbers::pi / 180.0;  // rad
inline constexpr double kCycle_s = 1.0 / 240.0;              // the rig's control cycle

}  // namespace sinew
