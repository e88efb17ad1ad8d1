// Actions that an operator asks of the robot: motors off, commands accepted in one session, motors
// off and latched, the end of what is latched, begin and end of a trajectory, a role to another
// participant, and a player's reference on live hardware.
#pragma once

#include <sinew_idl/operator.h>

namespace sinew::types {

using msg::OperatorAction;

}  // namespace sinew::types
