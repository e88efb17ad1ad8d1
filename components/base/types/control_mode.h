// The quantity that a motor controller regulates: nothing (the motor is off), torque, position
// (with an inner loop of velocity and torque) or velocity (with an inner loop of torque).
//
// The values of the CAN protocol (bridge/can/codec.h) are the same modes with other numbers.
#pragma once

#include <sinew_idl/joint.h>

namespace sinew::types {

using ControlMode = msg::CommandMode;

}  // namespace sinew::types
