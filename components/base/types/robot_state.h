// State of the robot, decided by its state provider, and where a message comes from: hardware, a
// simulation or a recording that is played.
//
// Armed: commands are accepted. Damped: armed, but commands are missing, and the provider damps or
// holds. Fault and estopped are latched until the operator's reset.
#pragma once

#include <sinew_idl/joint.h>

namespace sinew::types {

using msg::Origin;
using msg::RobotState;

// Commands move the robot, or the provider bridges their gap.
constexpr bool MayMove(RobotState state) noexcept {
  return state == RobotState::kArmed || state == RobotState::kDamped;
}

}  // namespace sinew::types
