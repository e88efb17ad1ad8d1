// Actions that an operator asks of the robot: motors off, commands accepted in one session, motors
// off and latched, the end of what is latched, begin and end of a trajectory, a role to another
// participant, and a player's reference on live hardware.
#pragma once

#include <sinew_idl/operator.h>

#include "components/base/types/robot_state.h"

namespace sinew::types {

using msg::OperatorAction;

// The robot's state says that it was done: arm, disarm, estop, reset.
inline bool HasReached(RobotState state, OperatorAction action) noexcept {
  switch (action) {
    case OperatorAction::kArm:
      return MayMove(state);
    case OperatorAction::kDisarm:  // in fault or estopped the motors are off already
      return state == RobotState::kDisarmed || state == RobotState::kFault ||
             state == RobotState::kEstopped;
    case OperatorAction::kEstop:
      return state == RobotState::kEstopped;
    default:
      return state == RobotState::kDisarmed;
  }
}

// It is meant for the session that runs, and bound to it.
inline bool IsBoundToSession(OperatorAction action) noexcept {
  return action == OperatorAction::kArm || action == OperatorAction::kReset;
}

}  // namespace sinew::types
