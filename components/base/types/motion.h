// Motion that set-up phases and experiments ask of a joint instead of following its reference.
#pragma once

namespace sinew::types {

enum class Motion {
  kNone,                // nothing: the reference counts
  kHold,                // stay where it is
  kMoveSlowly,          // to a target, with limited velocity
  kPushAgainstChamber,  // against the pneumatic element, with limited velocity and torque
};

}  // namespace sinew::types
