// ODrive CANSimple, firmware 0.5.x: bytes to structs and back. Pure: no sockets, no clock.
//
// Identifier = node * 32 + command; all fields little-endian (the project's odrive-cansimple.dbc,
// and docs/can-protocol.rst of the firmware). Units on the wire, kept in the names: motor
// revolutions, rev/s, A, V, and Nm as the controller understands them (its own torque_constant).
//
// Firmware differences (Firmware/communication/can_simple.cpp of the tags fw-v0.5.1, fw-v0.5.4,
// fw-v0.5.6):
//   0.5.1  heartbeat: state in 32 bits, no flags; 0x0F is only a velocity limit; 0x17 has no
//   current; commands
//          end at 0x18; requests are remote frames
//   0.5.4  heartbeat: state in 8 bits, trajectory flag; 0x19, 0x1A, 0x1B added; 0x14 carries the
//   setpoints of Id and
//          Iq, nothing measured; 0x17 has no current
//   0.5.6  heartbeat: flags of motor, encoder, controller; 64-bit motor error; 0x14 carries
//   setpoint and
//          measured Iq; 0x17 with current; 0x1C, 0x1D added; an empty data frame is a request, too
//
// Encode() gives exactly the bytes a frame has on the wire, Decode() nothing for a frame that is
// too short, of another command, remote, extended, or unknown to the firmware. Longer frames are
// accepted: additions come at the end. Floats pass as they are, NaN included: their user checks
// them. Any thread; allocates nothing.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include "bridge/can/frame.h"

namespace sinew::can {

enum class Firmware { k0_5_1, k0_5_4, k0_5_6 };

inline constexpr int kMaxNode = 63;
inline constexpr int kCommandBits = 5;

enum class Command : std::uint8_t {
  kHeartbeat = 0x01,
  kEstop = 0x02,
  kGetMotorError = 0x03,
  kGetEncoderError = 0x04,
  kGetSensorlessError = 0x05,
  kSetAxisNodeId = 0x06,
  kSetAxisState = 0x07,
  kGetEncoderEstimates = 0x09,
  kGetEncoderCount = 0x0A,
  kSetControllerMode = 0x0B,
  kSetInputPos = 0x0C,
  kSetInputVel = 0x0D,
  kSetInputTorque = 0x0E,
  kSetLimits = 0x0F,
  kStartAnticogging = 0x10,
  kSetTrajVelLimit = 0x11,
  kSetTrajAccelLimits = 0x12,
  kSetTrajInertia = 0x13,
  kGetIq = 0x14,
  kGetSensorlessEstimates = 0x15,
  kReboot = 0x16,
  kGetBusVoltageCurrent = 0x17,
  kClearErrors = 0x18,
  kSetLinearCount = 0x19,
  kSetPosGain = 0x1A,
  kSetVelGains = 0x1B,
  kGetAdcVoltage = 0x1C,
  kGetControllerError = 0x1D,
};

// Sent by the master of an axis alone: its setpoints, state, mode and number.
inline constexpr std::array kMasterCommands = {
    Command::kSetAxisNodeId, Command::kSetAxisState, Command::kSetControllerMode,
    Command::kSetInputPos,   Command::kSetInputVel,  Command::kSetInputTorque};
constexpr bool IsOfMaster(Command command) {
  return std::find(kMasterCommands.begin(), kMasterCommands.end(), command) !=
         kMasterCommands.end();
}

enum class AxisState : std::uint8_t {
  kUndefined = 0,
  kIdle = 1,
  kStartupSequence = 2,
  kFullCalibration = 3,
  kMotorCalibration = 4,
  kEncoderIndexSearch = 6,
  kEncoderOffsetCalibration = 7,
  kClosedLoopControl = 8,
  kLockinSpin = 9,
  kEncoderDirFind = 10,
  kHoming = 11,
  kHallPolarityCalibration = 12,
  kHallPhaseCalibration = 13,
};

enum class ControlMode : std::int32_t { kVoltage = 0, kTorque = 1, kVelocity = 2, kPosition = 3 };

enum class InputMode : std::int32_t {
  kInactive = 0,
  kPassthrough = 1,
  kVelRamp = 2,
  kPosFilter = 3,
  kMixChannels = 4,
  kTrapTraj = 5,
  kTorqueRamp = 6,
  kMirror = 7,
  kTuning = 8,
};

// Bits of the axis error (value table of the DBC).
namespace axis_error {
inline constexpr std::uint32_t kInvalidState = 0x1;
inline constexpr std::uint32_t kMotorFailed = 0x40;
inline constexpr std::uint32_t kSensorlessEstimatorFailed = 0x80;
inline constexpr std::uint32_t kEncoderFailed = 0x100;
inline constexpr std::uint32_t kControllerFailed = 0x200;
inline constexpr std::uint32_t kWatchdogTimerExpired = 0x800;
inline constexpr std::uint32_t kMinEndstopPressed = 0x1000;
inline constexpr std::uint32_t kMaxEndstopPressed = 0x2000;
inline constexpr std::uint32_t kEstopRequested = 0x4000;
inline constexpr std::uint32_t kHomingWithoutEndstop = 0x20000;
inline constexpr std::uint32_t kOverTemp = 0x40000;
inline constexpr std::uint32_t kUnknownPosition = 0x80000;
}  // namespace axis_error

struct Heartbeat {
  std::uint32_t axis_error = 0;
  AxisState axis_state = AxisState::kUndefined;
  bool motor_error = false;       // from 0.5.6 on
  bool encoder_error = false;     // from 0.5.6 on
  bool controller_error = false;  // from 0.5.6 on
  bool trajectory_done = false;   // from 0.5.4 on
  friend bool operator==(const Heartbeat&, const Heartbeat&) = default;
};
// Axis errors, with those of motor, encoder and controller that firmware 0.5.6 reports by flags:
// older ones have these bits in axis_error.
constexpr std::uint32_t ErrorsOf(const Heartbeat& heartbeat) {
  return heartbeat.axis_error | (heartbeat.motor_error ? axis_error::kMotorFailed : 0) |
         (heartbeat.encoder_error ? axis_error::kEncoderFailed : 0) |
         (heartbeat.controller_error ? axis_error::kControllerFailed : 0);
}
struct Estop {
  friend bool operator==(const Estop&, const Estop&) = default;
};
struct MotorError {
  std::uint64_t error = 0;  // 32 bits before 0.5.6
  friend bool operator==(const MotorError&, const MotorError&) = default;
};
struct EncoderError {
  std::uint32_t error = 0;
  friend bool operator==(const EncoderError&, const EncoderError&) = default;
};
struct SensorlessError {
  std::uint32_t error = 0;
  friend bool operator==(const SensorlessError&, const SensorlessError&) = default;
};
struct ControllerError {
  std::uint32_t error = 0;
  friend bool operator==(const ControllerError&, const ControllerError&) = default;
};
struct SetAxisNodeId {
  std::uint32_t node = 0;
  friend bool operator==(const SetAxisNodeId&, const SetAxisNodeId&) = default;
};
struct SetAxisState {
  AxisState state = AxisState::kUndefined;
  friend bool operator==(const SetAxisState&, const SetAxisState&) = default;
};
struct EncoderEstimates {
  double position_rev = 0.0;
  double velocity_rev_s = 0.0;
  friend bool operator==(const EncoderEstimates&, const EncoderEstimates&) = default;
};
struct EncoderCount {
  std::int32_t shadow_count = 0;
  std::int32_t count_in_cpr = 0;
  friend bool operator==(const EncoderCount&, const EncoderCount&) = default;
};
struct SetControllerMode {
  ControlMode control_mode = ControlMode::kTorque;
  InputMode input_mode = InputMode::kPassthrough;
  friend bool operator==(const SetControllerMode&, const SetControllerMode&) = default;
};
struct SetInputPos {
  double position_rev = 0.0;
  double velocity_feed_forward_rev_s = 0.0;  // steps of 0.001, +-32.767
  double torque_feed_forward_Nm = 0.0;       // steps of 0.001, +-32.767
  friend bool operator==(const SetInputPos&, const SetInputPos&) = default;
};
struct SetInputVel {
  double velocity_rev_s = 0.0;
  double torque_feed_forward_Nm = 0.0;
  friend bool operator==(const SetInputVel&, const SetInputVel&) = default;
};
struct SetInputTorque {
  double torque_Nm = 0.0;
  friend bool operator==(const SetInputTorque&, const SetInputTorque&) = default;
};
struct SetLimits {
  double velocity_limit_rev_s = 0.0;
  double current_limit_A = 0.0;  // 0.5.1 has none: not sent, decoded as 0
  friend bool operator==(const SetLimits&, const SetLimits&) = default;
};
struct StartAnticogging {
  friend bool operator==(const StartAnticogging&, const StartAnticogging&) = default;
};
struct SetTrajVelLimit {
  double velocity_limit_rev_s = 0.0;
  friend bool operator==(const SetTrajVelLimit&, const SetTrajVelLimit&) = default;
};
struct SetTrajAccelLimits {
  double acceleration_limit_rev_s2 = 0.0;
  double deceleration_limit_rev_s2 = 0.0;
  friend bool operator==(const SetTrajAccelLimits&, const SetTrajAccelLimits&) = default;
};
struct SetTrajInertia {
  double inertia_Nm_s2_rev = 0.0;
  friend bool operator==(const SetTrajInertia&, const SetTrajInertia&) = default;
};
struct Iq {
  double setpoint_A = 0.0;
  double measured_A =
      0.0;  // 0.5.4 sends the setpoints of Id and Iq here: both of them, no measurement
  friend bool operator==(const Iq&, const Iq&) = default;
};
struct SensorlessEstimates {
  double position_rev = 0.0;
  double velocity_rev_s = 0.0;
  friend bool operator==(const SensorlessEstimates&, const SensorlessEstimates&) = default;
};
struct Reboot {
  friend bool operator==(const Reboot&, const Reboot&) = default;
};
struct BusVoltageCurrent {
  double voltage_V = 0.0;
  double current_A = 0.0;  // from 0.5.6 on, else 0
  friend bool operator==(const BusVoltageCurrent&, const BusVoltageCurrent&) = default;
};
struct ClearErrors {
  friend bool operator==(const ClearErrors&, const ClearErrors&) = default;
};
struct SetLinearCount {
  std::int32_t position_counts = 0;
  friend bool operator==(const SetLinearCount&, const SetLinearCount&) = default;
};
struct SetPosGain {
  double gain_rev_s_rev = 0.0;
  friend bool operator==(const SetPosGain&, const SetPosGain&) = default;
};
struct SetVelGains {
  double gain_Nm_s_rev = 0.0;
  double integrator_gain_Nm_rev = 0.0;
  friend bool operator==(const SetVelGains&, const SetVelGains&) = default;
};
struct AdcVoltage {
  double voltage_V = 0.0;
  friend bool operator==(const AdcVoltage&, const AdcVoltage&) = default;
};
// The request of AdcVoltage: a data frame of one byte, not a remote frame.
struct AdcRequest {
  std::uint8_t gpio = 0;
  friend bool operator==(const AdcRequest&, const AdcRequest&) = default;
};

// The owner of a frame; nothing for extended and error frames. `command` may be none of the
// enum.
struct Address {
  int node = 0;
  Command command{};
};
std::optional<Address> AddressOf(const Frame& frame) noexcept;

constexpr std::uint32_t Identifier(int node, Command command) {
  return static_cast<std::uint32_t>(node) << kCommandBits | static_cast<std::uint32_t>(command);
}

// The command exists in this firmware.
bool Knows(Firmware firmware, Command command) noexcept;

// A frame for axis `node` (0..63). Message is one of the structs above. Fields the firmware has not
// are not sent.
template <class Message>
Frame Encode(int node, const Message& message, Firmware firmware = Firmware::k0_5_6) noexcept;

template <class Message>
std::optional<Message> Decode(const Frame& frame, Firmware firmware = Firmware::k0_5_6) noexcept;

// The remote frame that asks for a Get... message.
Frame EncodeRequest(int node, Command command) noexcept;
// It asks this firmware for data: a remote frame, or from 0.5.6 on an empty one, of a Get...
// command.
bool IsRequest(const Frame& frame, Firmware firmware = Firmware::k0_5_6) noexcept;

// A command of a master (IsOfMaster) that is complete: noise on the bus is none.
bool CommandsAxis(const Frame& frame, Firmware firmware = Firmware::k0_5_6) noexcept;

// The same frame without the bytes behind its last signal (a torque setpoint then takes 4 bytes of
// the DBC's 8, and 95 bit times instead of 135). The firmware reads signals, never the length.
Frame Trim(Frame frame) noexcept;

}  // namespace sinew::can
