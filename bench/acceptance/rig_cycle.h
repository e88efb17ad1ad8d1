// The cycle of the rig's controller, in which every acceptance run on the surrogate steps.
#pragma once

namespace sinew::acceptance {

inline constexpr double kCycle_s = 1.0 / 240.0;

}  // namespace sinew::acceptance
