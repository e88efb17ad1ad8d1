#include "bridge/virtual_axes/axis_model.h"

#include <algorithm>
#include <cmath>

#include "components/base/types/angle.h"
#include "components/base/types/control_mode.h"

namespace sinew::virtual_axes {
namespace {

using can::AxisState;
using can::Command;
using can::Firmware;

constexpr std::int64_t kReboot_ns = 300 * kMs_ns;
constexpr double kOverspeedFactor = 1.2;             // vel_limit_tolerance of the firmware
constexpr std::uint32_t kControllerOverspeed = 0x1;  // bits of the controller error
constexpr std::uint32_t kControllerInvalidMode = 0x2;

// Order of the schedules.
constexpr std::array<Command, AxisModel::kCyclicMessages> kCyclic = {Command::kHeartbeat,
                                                                     Command::kGetEncoderEstimates,
                                                                     Command::kGetIq,
                                                                     Command::kGetBusVoltageCurrent,
                                                                     Command::kGetMotorError,
                                                                     Command::kGetEncoderError,
                                                                     Command::kGetControllerError};

// Sequences that end at once here.
constexpr std::array kSequences = {AxisState::kStartupSequence,
                                   AxisState::kFullCalibration,
                                   AxisState::kMotorCalibration,
                                   AxisState::kEncoderIndexSearch,
                                   AxisState::kEncoderOffsetCalibration,
                                   AxisState::kEncoderDirFind,
                                   AxisState::kHoming,
                                   AxisState::kHallPolarityCalibration,
                                   AxisState::kHallPhaseCalibration};

double FiniteOrZero(double value) { return std::isfinite(value) ? value : 0.0; }

std::int32_t ToInt32(double value) {
  return static_cast<std::int32_t>(std::clamp(FiniteOrZero(value), -2147483648.0, 2147483647.0));
}

}  // namespace

AxisModel::AxisModel(const AxisConfig& config)
    : config_(config),
      velocity_limit_rev_s_(config.velocity_limit_rev_s),
      current_limit_A_(config.current_limit_A),
      encoder_(config.encoder_fault) {
  const AxisRates& r = config.rates;
  const std::array every_ms = {r.heartbeat_ms,       r.encoder_ms,     r.iq_ms,
                               r.bus_voltage_ms,     r.motor_error_ms, r.encoder_error_ms,
                               r.controller_error_ms};
  for (std::size_t i = 0; i < kCyclicMessages; ++i) schedules_[i] = Schedule(every_ms[i]);
}

MotorState AxisModel::MotorOf(const provider::PlantSensors& sensors) const {
  const auto j = static_cast<std::size_t>(config_.joint);
  return {config_.direction * sensors.motor_position_rad[j] / types::kTwoPi + config_.zero_rev,
          config_.direction * sensors.motor_velocity_rad_s[j] / types::kTwoPi,
          config_.direction * sensors.motor_current_A[j]};
}

MotorState AxisModel::Reported(const provider::PlantSensors& sensors, std::int64_t now_ns) {
  MotorState motor = MotorOf(sensors);
  const FalseEncoder::Reading reading = encoder_.Of(
      {motor.position_rev, motor.velocity_rev_s}, 1e-9 * static_cast<double>(now_ns - started_ns_));
  motor.position_rev = reading.position;
  motor.velocity_rev_s = reading.velocity;
  return motor;
}

void AxisModel::Start(std::int64_t now_ns, std::int64_t spread_ns) {
  fed_ns_ = started_ns_ = now_ns;
  for (Schedule& schedule : schedules_) schedule.Start(now_ns, spread_ns);
}

std::optional<can::Frame> AxisModel::Take(const can::Frame& frame, const MotorState& motor,
                                          std::int64_t now_ns) {
  if (is_rebooting(now_ns)) return std::nullopt;
  const Command command = can::AddressOf(frame)->command;
  fed_ns_ = now_ns;
  if (!can::Knows(config_.firmware, command)) return std::nullopt;
  if (can::IsRequest(frame, config_.firmware)) return Message(command, motor);
  if (command == Command::kGetAdcVoltage) {
    return can::Decode<can::AdcRequest>(frame, config_.firmware) ? Message(command, motor)
                                                                 : std::nullopt;
  }
  TakeCommand(command, frame, motor, now_ns);
  return std::nullopt;
}

void AxisModel::TakeCommand(Command command, const can::Frame& frame, const MotorState& motor,
                            std::int64_t now_ns) {
  const Firmware firmware = config_.firmware;
  switch (command) {
    case Command::kEstop:
      Fail(can::axis_error::kEstopRequested);
      break;
    case Command::kSetAxisNodeId:
      if (const auto m = can::Decode<can::SetAxisNodeId>(frame, firmware);
          m && m->node <= can::kMaxNode) {
        config_.node = static_cast<int>(m->node);
      }
      break;
    case Command::kSetAxisState:
      if (const auto m = can::Decode<can::SetAxisState>(frame, firmware)) {
        TakeState(m->state, motor);
      }
      break;
    case Command::kSetControllerMode:
      if (const auto m = can::Decode<can::SetControllerMode>(frame, firmware)) {
        TakeMode(m->control_mode);
      }
      break;
    case Command::kSetInputPos:
      if (const auto m = can::Decode<can::SetInputPos>(frame, firmware)) {
        input_position_rev_ = m->position_rev;
        input_velocity_rev_s_ = m->velocity_feed_forward_rev_s;
        input_torque_Nm_ = m->torque_feed_forward_Nm;
      }
      break;
    case Command::kSetInputVel:
      if (const auto m = can::Decode<can::SetInputVel>(frame, firmware)) {
        input_velocity_rev_s_ = m->velocity_rev_s;
        input_torque_Nm_ = m->torque_feed_forward_Nm;
      }
      break;
    case Command::kSetInputTorque:
      if (const auto m = can::Decode<can::SetInputTorque>(frame, firmware)) {
        input_torque_Nm_ = m->torque_Nm;
      }
      break;
    case Command::kSetLimits:
      if (const auto m = can::Decode<can::SetLimits>(frame, firmware)) TakeLimits(*m);
      break;
    case Command::kReboot:
      Reboot(now_ns);
      break;
    case Command::kClearErrors:
      ClearErrors();
      break;
    default:
      break;  // gains, trajectories, anticogging: without effect
  }
}

void AxisModel::TakeReference(double position_rev, std::int64_t now_ns) {
  if (is_rebooting(now_ns)) return;
  fed_ns_ = now_ns;
  if (mode_ != can::ControlMode::kPosition) return;
  input_position_rev_ = position_rev;
  input_velocity_rev_s_ = input_torque_Nm_ = 0.0;
}

void AxisModel::TakeState(AxisState state, const MotorState& motor) {
  if (state == AxisState::kClosedLoopControl) {
    if (error_ != 0 || state_ == AxisState::kClosedLoopControl) return;
    // The firmware starts from where the motor is: no jump before the first setpoint.
    input_position_rev_ = motor.position_rev;
    input_velocity_rev_s_ = input_torque_Nm_ = 0.0;
    state_ = AxisState::kClosedLoopControl;
  } else if (state == AxisState::kIdle ||
             std::find(kSequences.begin(), kSequences.end(), state) != kSequences.end()) {
    state_ = AxisState::kIdle;
  } else {
    Fail(can::axis_error::kInvalidState);
  }
}

void AxisModel::TakeMode(can::ControlMode mode) {
  switch (mode) {
    case can::ControlMode::kTorque:
    case can::ControlMode::kVelocity:
    case can::ControlMode::kPosition:
      mode_ = mode;
      return;
    case can::ControlMode::kVoltage:  // not for this plant
      break;
  }
  controller_error_ |= kControllerInvalidMode;
  Fail(can::axis_error::kControllerFailed);
}

void AxisModel::TakeLimits(const can::SetLimits& limits) {
  if (std::isfinite(limits.velocity_limit_rev_s)) {
    velocity_limit_rev_s_ = std::abs(limits.velocity_limit_rev_s);
  }
  if (config_.firmware != Firmware::k0_5_1 && std::isfinite(limits.current_limit_A)) {
    current_limit_A_ = std::abs(limits.current_limit_A);
  }
}

void AxisModel::ClearErrors() {
  error_ = encoder_error_ = controller_error_ = 0;
  motor_error_ = 0;
}

void AxisModel::Reboot(std::int64_t now_ns) {
  state_ = AxisState::kIdle;
  ClearErrors();
  velocity_limit_rev_s_ = config_.velocity_limit_rev_s;
  current_limit_A_ = config_.current_limit_A;
  fed_ns_ = silent_until_ns_ = now_ns + kReboot_ns;
}

DueFrames<AxisModel::kCyclicMessages> AxisModel::Due(const MotorState& motor, std::int64_t now_ns) {
  DueFrames<kCyclicMessages> due;
  for (std::size_t i = 0; i < kCyclicMessages; ++i) {
    if (!schedules_[i].IsDue(now_ns) || is_rebooting(now_ns)) continue;
    if (const auto frame = Message(kCyclic[i], motor)) due.Add(*frame);
  }
  return due;
}

std::optional<can::Frame> AxisModel::Message(Command command, const MotorState& motor) const {
  const Firmware firmware = config_.firmware;
  if (silenced_ || !can::Knows(firmware, command)) return std::nullopt;
  const auto encode = [&](const auto& message) {
    return can::Encode(config_.node, message, firmware);
  };
  switch (command) {
    case Command::kHeartbeat:
      return encode(can::Heartbeat{error_, state_, motor_error_ != 0, encoder_error_ != 0,
                                   controller_error_ != 0, false});
    case Command::kGetMotorError:
      return encode(can::MotorError{motor_error_});
    case Command::kGetEncoderError:
      return encode(can::EncoderError{encoder_error_});
    case Command::kGetControllerError:
      return encode(can::ControllerError{controller_error_});
    case Command::kGetSensorlessError:
      return encode(can::SensorlessError{});
    case Command::kGetEncoderEstimates:
      return encode(can::EncoderEstimates{motor.position_rev, motor.velocity_rev_s});
    case Command::kGetSensorlessEstimates:
      return encode(can::SensorlessEstimates{motor.position_rev, motor.velocity_rev_s});
    case Command::kGetEncoderCount: {
      const double counts = motor.position_rev * config_.encoder_counts_rev;
      const double within =
          counts - config_.encoder_counts_rev * std::floor(counts / config_.encoder_counts_rev);
      return encode(can::EncoderCount{ToInt32(std::floor(counts)), ToInt32(within)});
    }
    case Command::kGetIq:
      // 0.5.4 sends its two setpoints, Id and Iq, in place of setpoint and measurement.
      if (firmware == Firmware::k0_5_4) return encode(can::Iq{0.0, iq_setpoint_A_});
      return encode(can::Iq{iq_setpoint_A_, motor.iq_A});
    case Command::kGetBusVoltageCurrent: {
      const double power_W =
          motor.iq_A * config_.torque_constant_Nm_A * types::kTwoPi * motor.velocity_rev_s;
      return encode(can::BusVoltageCurrent{config_.bus_voltage_V, power_W / config_.bus_voltage_V});
    }
    case Command::kGetAdcVoltage:
      return encode(can::AdcVoltage{0.0});
    default:
      return std::nullopt;
  }
}

void AxisModel::CheckWatchdog(std::int64_t now_ns) {
  if (config_.watchdog_s <= 0.0 || is_rebooting(now_ns)) return;
  if (static_cast<double>(now_ns - fed_ns_) > 1e9 * config_.watchdog_s) {
    Fail(can::axis_error::kWatchdogTimerExpired);
  }
}

void AxisModel::CheckSpeed(const MotorState& motor) {
  if (state_ != AxisState::kClosedLoopControl) return;
  if (std::abs(motor.velocity_rev_s) > kOverspeedFactor * velocity_limit_rev_s_) {
    controller_error_ |= kControllerOverspeed;
    Fail(can::axis_error::kControllerFailed);
  }
}

void AxisModel::Fail(std::uint32_t axis_error) {
  error_ |= axis_error;
  state_ = AxisState::kIdle;
}

void AxisModel::Drive(const MotorState& motor, provider::PlantCommand* command) {
  const AxisConfig& c = config_;
  const auto j = static_cast<std::size_t>(c.joint);
  command->mode[j] = types::ControlMode::kIdle;
  command->motor_torque_Nm[j] = 0.0;
  iq_setpoint_A_ = 0.0;
  if (state_ != AxisState::kClosedLoopControl) return;
  const double output_rad_per_rev = c.direction * types::kTwoPi / c.gear_ratio;
  const double velocity_rev_s = std::clamp(FiniteOrZero(input_velocity_rev_s_),
                                           -velocity_limit_rev_s_, velocity_limit_rev_s_);
  command->velocity_rad_s[j] = velocity_rev_s * output_rad_per_rev;
  switch (mode_) {
    case can::ControlMode::kTorque: {
      command->mode[j] = types::ControlMode::kTorque;
      const double current_A =
          std::clamp(FiniteOrZero(input_torque_Nm_) / c.controller_torque_constant_Nm_A,
                     -current_limit_A_, current_limit_A_);
      iq_setpoint_A_ = current_A;
      command->motor_torque_Nm[j] = c.direction * current_A * c.torque_constant_Nm_A;
      return;
    }
    case can::ControlMode::kPosition:
      command->mode[j] = types::ControlMode::kPosition;
      if (std::isfinite(input_position_rev_)) {
        command->position_rad[j] = (input_position_rev_ - c.zero_rev) * output_rad_per_rev;
      }
      break;
    case can::ControlMode::kVelocity:
      command->mode[j] = types::ControlMode::kVelocity;
      break;
    case can::ControlMode::kVoltage:
      break;
  }
  iq_setpoint_A_ = motor.iq_A;
}

}  // namespace sinew::virtual_axes
