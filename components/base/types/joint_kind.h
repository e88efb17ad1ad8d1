// Kind of a joint. Names and comments of the project are written for a rotary joint; a linear
// (prismatic) joint reads m for rad and N for Nm (docs/decisions/0003).
#pragma once

#include <sinew_idl/joint.h>

namespace sinew::types {

using msg::JointKind;

}  // namespace sinew::types
