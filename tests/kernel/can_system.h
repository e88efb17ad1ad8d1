// What the two halves of the system test agree on: twelve joints, their commands and their frames.
#pragma once

#include <cstdint>

#include "bridge/can/codec.h"

namespace sinew::can_system {

inline constexpr int kJoints = 12;
inline constexpr int kSensorNodes = 4;  // of the first joints
inline constexpr double kTorqueConstant_Nm_A = 0.0159155;
inline constexpr double kControllerTorqueConstant_Nm_A = 0.0137833;
inline constexpr double kGearRatio = 100.0;

// No two joints are alike: a frame that went to the wrong one is seen.
constexpr int AxisNode(int joint) { return joint + 1; }
constexpr int SensorNode(int joint) { return joint + 33; }
constexpr int Direction(int joint) { return joint % 2 == 0 ? 1 : -1; }
constexpr double ZeroRev(int joint) { return 100.25 * joint - 50.0; }
constexpr double OutputZero_rad(int joint) { return 0.125 * joint; }

// The command that answers tick k is number k modulo kCommands: each joint and number has a torque
// of its own.
inline constexpr int kCommands = 64;
constexpr double MotorTorque_Nm(int joint, int number) {
  return 2e-3 * (kJoints - joint) + 1e-5 * number;
}
// The frame that has to follow from it.
inline can::Frame Setpoint(int joint, int number) {
  const double torque_Nm = Direction(joint) * MotorTorque_Nm(joint, number) *
                           kControllerTorqueConstant_Nm_A / kTorqueConstant_Nm_A;
  return can::Trim(can::Encode(AxisNode(joint), can::SetInputTorque{torque_Nm}));
}

// The identifier is of one of our axes or sensor nodes.
constexpr bool IsOurs(std::uint32_t id) {
  const auto node = static_cast<int>(id >> can::kCommandBits);
  return (node >= AxisNode(0) && node < AxisNode(kJoints)) ||
         (node >= SensorNode(0) && node < SensorNode(kSensorNodes));
}

// Files of a run.
inline constexpr const char* kLogFile = "candump.log";
inline constexpr const char* kMarksFile = "marks.txt";  // lines of "NAME VALUE"

}  // namespace sinew::can_system
