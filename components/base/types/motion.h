// Motion that set-up phases and experiments ask of a joint instead of following its reference: none
// (the reference counts), stay where it is, move to a target with limited velocity, or push against
// the pneumatic element with limited velocity and torque.
#pragma once

#include <sinew_idl/operator.h>

namespace sinew::types {

using Motion = msg::MotionKind;

}  // namespace sinew::types
