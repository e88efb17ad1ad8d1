// Actions that an operator asks of the robot.
#pragma once

namespace sinew::types {

enum class OperatorAction {
  kDisarm,        // motors off
  kArm,           // of one session: commands are accepted
  kEstop,         // motors off, latched
  kReset,         // ends a latched fault or estop: disarmed
  kStart,         // reference generators: start the trajectory
  kStop,          // reference generators: end the trajectory
  kHandover,      // a role goes to the participant that is named
  kPermitReplay,  // the named player's reference may move live hardware
};

}  // namespace sinew::types
