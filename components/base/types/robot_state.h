// State of the robot, decided by its state provider, and where a message comes from.
#pragma once

namespace sinew::types {

enum class RobotState {
  kDisarmed,  // motors off, no command is accepted
  kArmed,     // commands are accepted
  kDamped,    // armed, but commands are missing: the provider damps or holds
  kFault,     // latched until the operator's reset
  kEstopped,  // latched until the operator's reset
};

// Commands move the robot, or the provider bridges their gap.
constexpr bool MayMove(RobotState state) noexcept {
  return state == RobotState::kArmed || state == RobotState::kDamped;
}

enum class Origin {
  kLive,    // hardware
  kSim,     // simulation
  kReplay,  // a recording that is played
};

}  // namespace sinew::types
