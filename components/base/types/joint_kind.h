// Kind of a joint. Names and comments of the project are written for a rotary joint; a linear joint
// reads m for rad and N for Nm (docs/decisions/0003).
#pragma once

namespace sinew::types {

enum class JointKind { kRotary, kLinear };

}  // namespace sinew::types
