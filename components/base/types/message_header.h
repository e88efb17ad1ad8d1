// The cycle and the session that a message belongs to (header of every topic, idl/header.idl).
//
// One that is made without an origin says that it is of live hardware.
#pragma once

#include <sinew_idl/header.h>

#include "components/base/types/robot_state.h"

namespace sinew::types {

using MessageHeader = msg::Header;

}  // namespace sinew::types
