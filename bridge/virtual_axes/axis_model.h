// One motor controller that exists only as frames: an ODrive with firmware 0.5.x
// (Firmware/communication/can/can_simple.cpp, MotorControl/axis.cpp of the tags in can/codec.h).
//
// It has states and errors, control modes and setpoints, limits of current and speed, watchdog,
// estop and reboot, and sends messages cyclically and on request. Current from a torque setpoint:
//
//     Iq = clamp(T / controller_torque_constant, +-current limit)
//     motor torque = direction * Iq * torque_constant
//
// Position and velocity control are the plant's: gains that arrive over the bus are ignored.
// Calibration and homing end at once. After Reboot the axis is silent for 0.3 s. Any frame feeds
// the watchdog.
//
// Pure: frames, the motor's state and the time come in. One thread; allocates nothing.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "bridge/can/codec.h"
#include "bridge/virtual_axes/axes_config.h"
#include "bridge/virtual_axes/schedule.h"
#include "components/robot/provider/plant.h"

namespace sinew::virtual_axes {

// As the controller measures it: its own direction and zero.
struct MotorState {
  double position_rev = 0.0;
  double velocity_rev_s = 0.0;
  double iq_A = 0.0;
};

class AxisModel {
 public:
  static constexpr std::size_t kCyclicMessages = 7;

  explicit AxisModel(const AxisConfig& config);

  int bus() const { return config_.bus; }
  int node() const { return config_.node; }  // Set_Axis_Node_ID changes it
  MotorState MotorOf(const provider::PlantSensors& sensors) const;
  // As its encoder reports it, which is what it sends.
  MotorState Reported(const provider::PlantSensors& sensors, std::int64_t now_ns);

  // The first cyclic messages are due after `spread_ns`.
  void Start(std::int64_t now_ns, std::int64_t spread_ns);
  // A frame to this node. Returns the answer to a request.
  std::optional<can::Frame> Take(const can::Frame& frame, const MotorState& motor,
                                 std::int64_t now_ns);
  // A reference of a gateway: moves an axis in position control, feeds the watchdog of any.
  void TakeReference(double position_rev, std::int64_t now_ns);
  // The cyclic messages of this time.
  DueFrames<kCyclicMessages> Due(const MotorState& motor, std::int64_t now_ns);

  void CheckWatchdog(std::int64_t now_ns);
  void CheckSpeed(const MotorState& motor);
  // The axis' part of the plant's command: mode, motor torque, position and velocity of its joint.
  void Drive(const MotorState& motor, provider::PlantCommand* command);

  // Silent: sends nothing. For tests and for tools that stage failures.
  void Silence(bool silent) { silenced_ = silent; }
  void Fail(std::uint32_t axis_error);
  void Falsify(const EncoderFault& fault) { encoder_.Plant(fault); }
  bool is_silent(std::int64_t now_ns) const { return silenced_ || is_rebooting(now_ns); }

  can::AxisState state() const { return state_; }
  std::uint32_t error() const { return error_; }
  double input_torque_Nm() const { return input_torque_Nm_; }  // the last setpoint, as received

 private:
  bool is_rebooting(std::int64_t now_ns) const { return now_ns < silent_until_ns_; }
  void TakeCommand(can::Command command, const can::Frame& frame, const MotorState& motor,
                   std::int64_t now_ns);
  void TakeState(can::AxisState state, const MotorState& motor);
  void TakeMode(can::ControlMode mode);
  void TakeLimits(const can::SetLimits& limits);
  void ClearErrors();
  void Reboot(std::int64_t now_ns);
  // Nothing when the axis is silenced or its firmware has no such message.
  std::optional<can::Frame> Message(can::Command command, const MotorState& motor) const;

  AxisConfig config_;
  can::AxisState state_ = can::AxisState::kIdle;
  std::uint32_t error_ = 0;
  std::uint64_t motor_error_ = 0;
  std::uint32_t encoder_error_ = 0;
  std::uint32_t controller_error_ = 0;
  can::ControlMode mode_ = can::ControlMode::kPosition;
  double input_position_rev_ = 0.0;
  double input_velocity_rev_s_ = 0.0;
  double input_torque_Nm_ = 0.0;
  double velocity_limit_rev_s_;
  double current_limit_A_;
  double iq_setpoint_A_ = 0.0;
  FalseEncoder encoder_;
  std::int64_t started_ns_ = 0;
  std::int64_t fed_ns_ = 0;
  std::int64_t silent_until_ns_ = 0;
  bool silenced_ = false;
  std::array<Schedule, kCyclicMessages> schedules_;
};

}  // namespace sinew::virtual_axes
