// The quantity that a motor controller regulates.
//
// CommandMode of idl/joint.idl and the values of the CAN protocol (bridge/can/codec.h) are the same
// modes as they are written to the wire; their numbers may differ from these.
#pragma once

namespace sinew::types {

enum class ControlMode {
  kIdle,      // the motor is off
  kTorque,    // torque
  kPosition,  // position, with an inner loop of velocity and torque
  kVelocity,  // velocity, with an inner loop of torque
};

}  // namespace sinew::types
