#include "bridge/joints/can_joint.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bridge/joints/limiter.h"
#include "components/base/types/angle.h"

namespace sinew::bridge {
namespace {

using types::ControlMode;
using types::FaultCause;

constexpr const char* kBeyondCompact = "its position is beyond the range of the compact exchange";

}  // namespace

ActuatorCommand CommandOf(const provider::PlantCommand& command, std::size_t joint) {
  return {command.mode[joint],         command.motor_torque_Nm[joint],
          command.position_rad[joint], command.velocity_rad_s[joint],
          command.valve_open[joint],   command.compressor_on[joint],
          command.vent_open[joint]};
}

CanJoint::CanJoint(const JointConfig& config, const BridgeTiming& timing,
                   std::unique_ptr<JointExchange> exchange, FrameOutbox* outbox)
    : config_(config),
      timing_(timing),
      exchange_(std::move(exchange)),
      outbox_(outbox),
      measured_(config),
      fault_(config),
      encoders_(config),
      axis_(ToNs(timing.closed_loop_timeout_s)) {}

void CanJoint::Forget() {
  measured_ = JointMeasurement(config_);
  fault_ = FaultLatch(config_);
  axis_ = AxisStateMachine(ToNs(timing_.closed_loop_timeout_s));
  setpoint_rad_ = 0.0;
  valve_sequence_ = 0;
  estimates_request_ = iq_request_ = RequestTimer{};
}

void CanJoint::Reset() {
  Forget();
  exchange_->RequestIdle();
  exchange_->Send(can::ClearErrors{});
}

void CanJoint::Start(std::int64_t now_ns) {
  measured_.iq_ns = now_ns;
  AssessZero(measured_, &fault_);
}

void CanJoint::ClearFault(std::int64_t now_ns) {
  if (fault_.ClearReported() && axis_.phase() != AxisPhase::kIdle) {
    axis_.GoIdle(now_ns);
    exchange_->RequestIdle();
  }
  axis_.ForgetErrors();
  measured_.ClearErrors(now_ns + kClearing_ns);
  exchange_->Send(can::ClearErrors{});
  if (config_.home_by_whole_turns) measured_.home_rev = WholeTurnsOff(measured_);
}

void CanJoint::ShutDown(std::int64_t now_ns) {
  axis_.GoIdle(now_ns);
  SendNeutral();
  exchange_->RequestIdle();
  SendValves({});
}

void CanJoint::Assess(std::int64_t now_ns, const can::Transport& bus) {
  const ErrorAction action = axis_.AssessErrors(now_ns, fault_, &measured_);
  if (action == ErrorAction::kClear) exchange_->Send(can::ClearErrors{});
  const bool active = axis_.phase() == AxisPhase::kActive;
  if (!active) encoders_.Restart();
  encoders_.Update(measured_, now_ns);
  const FaultRule* rule = AssessFaults({.measured = measured_,
                                        .timing = timing_,
                                        .encoders = encoders_,
                                        .active = active,
                                        .now_ns = now_ns},
                                       &fault_);
  if (rule != nullptr && rule->silence && bus.link() != can::Link::kUp) {
    fault_.Append("bus '" + bus.name() + "' is " + can::LinkName(bus.link()));
  }
  if (action != ErrorAction::kRequestCodes) return;
  for (const can::Command command : {can::Command::kGetMotorError, can::Command::kGetEncoderError,
                                     can::Command::kGetControllerError}) {
    if (can::Knows(config_.firmware, command)) exchange_->RequestData(command);
  }
}

void CanJoint::Command(const ActuatorCommand& command, double period_s, std::int64_t now_ns) {
  const bool finite = std::isfinite(command.motor_torque_Nm) &&
                      std::isfinite(command.position_rad) && std::isfinite(command.velocity_rad_s);
  if (command.mode != ControlMode::kIdle && !finite) {
    fault_.Fail(FaultCause::kNotFinite);
  }
  const bool was_active = axis_.phase() == AxisPhase::kActive;
  const AxisDecision decision = axis_.Step(command.mode, measured_, now_ns, &fault_);
  range_ = was_active ? Narrowed(config_.limits, range_, measured_.position_rad())
                      : RangeFrom(config_.limits, measured_.position_rad());
  if (decision.restart_setpoint) setpoint_rad_ = measured_.motor_position_at_output_rad();
  AxisRequest request = decision.request;
  const bool arms = request == AxisRequest::kClosedLoop || request == AxisRequest::kMode;
  if (arms && !exchange_->Holds(measured_)) {
    fault_.Fail(FaultCause::kOutOfRange, kBeyondCompact);
    request = AxisRequest::kIdle;
  }
  switch (request) {
    case AxisRequest::kIdle:
      exchange_->RequestIdle();
      break;
    case AxisRequest::kClosedLoop:
      exchange_->RequestClosedLoop(axis_.mode(), measured_);
      break;
    case AxisRequest::kMode:
      if (axis_.mode() == ControlMode::kPosition) exchange_->SendMeasuredPosition(measured_);
      SendNeutral();
      exchange_->RequestMode(axis_.mode());
      break;
    case AxisRequest::kModeAgain:
      exchange_->RequestMode(axis_.mode());
      break;
    case AxisRequest::kNone:
      break;
  }
  if (decision.follows_command && !fault_.active()) {
    SendSetpoint(command, period_s, now_ns);
  } else {
    SendNeutral();
  }
}

void CanJoint::SendSetpoint(const ActuatorCommand& command, double period_s, std::int64_t now_ns) {
  const JointConfig& c = config_;
  const double rev_per_rad = c.direction * c.gear_ratio / types::kTwoPi;
  const Envelope envelope = EnvelopeOf(c, period_s);
  const double age_s = 1e-9 * static_cast<double>(now_ns - measured_.motion_ns());
  const MeasuredMotion motion{measured_.motor_velocity_rad_s() / c.gear_ratio,
                              measured_.position_rad(), std::max(0.0, age_s - period_s)};
  switch (axis_.mode()) {
    case ControlMode::kTorque: {
      const double torque_Nm =
          LimitTorque(c.limits, envelope, range_, motion, command.motor_torque_Nm);
      exchange_->Send(can::SetInputTorque{
          c.direction * torque_Nm * c.controller_torque_constant_Nm_A / c.torque_constant_Nm_A});
      break;
    }
    case ControlMode::kPosition: {
      const PositionSetpoint setpoint =
          LimitPosition(c.limits, envelope, setpoint_rad_, period_s,
                        {command.position_rad, command.velocity_rad_s});
      setpoint_rad_ = setpoint.position_rad;
      if (!exchange_->SendPosition(measured_.Revolutions(setpoint.position_rad),
                                   setpoint.velocity_rad_s * rev_per_rad)) {
        fault_.Fail(FaultCause::kOutOfRange, "the reference is beyond the compact exchange");
      }
      break;
    }
    case ControlMode::kVelocity: {
      const double velocity_rad_s =
          LimitVelocity(c.limits, envelope, motion, command.velocity_rad_s);
      exchange_->Send(can::SetInputVel{velocity_rad_s * rev_per_rad, 0.0});
      break;
    }
    case ControlMode::kIdle:
      break;
  }
}

void CanJoint::SendNeutral() {
  if (!exchange_->SendNeutral(axis_.mode(), measured_)) {
    fault_.Fail(FaultCause::kOutOfRange, kBeyondCompact);
  }
}

void CanJoint::SendValves(const ActuatorCommand& command) {
  if (!config_.output) return;
  const can::ValveCommand valves{command.valve_open, command.compressor_on, command.vent_open,
                                 valve_sequence_++,
                                 static_cast<std::uint16_t>(timing_.valve_timeout_ms)};
  outbox_->Post(config_.bus, can::Encode(config_.output->node, valves));
}

void CanJoint::RequestEstimates(std::int64_t now_ns) {
  estimates_request_.Start(now_ns);
  exchange_->RequestData(can::Command::kGetEncoderEstimates);
}

void CanJoint::RequestIq(std::int64_t now_ns) {
  iq_request_.Start(now_ns);
  exchange_->RequestData(can::Command::kGetIq);
}

std::int64_t CanJoint::idle_reported_ns() const {
  const bool idle =
      axis_.phase() == AxisPhase::kIdle && measured_.heartbeat.axis_state == can::AxisState::kIdle;
  return idle ? measured_.heartbeat_ns : 0;
}

void CanJoint::HearMaster() { fault_.Fail(FaultCause::kAnotherMaster); }

CanJoint::News CanJoint::TakeFromAxis(const can::Received& received) {
  if (can::CommandsAxis(received.frame, config_.firmware)) {
    HearMaster();
    return {};
  }
  switch (measured_.TakeFromAxis(received, &fault_)) {
    case Taken::kEstimates:
      return {.answer_us = estimates_request_.Stop(received.stamp_ns)};
    case Taken::kIq:
      return {.answer_us = iq_request_.Stop(received.stamp_ns)};
    case Taken::kMalformed:
      return {.malformed = true};
    case Taken::kStored:
    case Taken::kUnused:
      break;
  }
  return {};
}

CanJoint::News CanJoint::TakeFromNode(const can::Received& received) {
  return {.malformed = measured_.TakeFromNode(received, &fault_) == Taken::kMalformed};
}

void CanJoint::TakeFromGateway(const can::EncoderEstimates& estimates, double iq_A,
                               std::int64_t stamp_ns) {
  if (!CompactLink::Fits(estimates.position_rev)) {
    // Held at the end of its field: it may be anywhere beyond.
    fault_.Fail(FaultCause::kOutOfRange, kBeyondCompact);
  }
  measured_.TakeEstimates(estimates, stamp_ns, &fault_);
  measured_.iq_A = iq_A;
  measured_.iq_ns = stamp_ns;
}

void CanJoint::Fill(std::size_t j, std::int64_t now_ns, provider::PlantSensors* sensors) {
  const JointConfig& c = config_;
  const JointMeasurement& m = measured_;
  sensors->position_rad[j] = m.position_rad();
  sensors->velocity_rad_s[j] = m.velocity_rad_s();
  sensors->motor_position_rad[j] = m.motor_position_rad();
  sensors->motor_velocity_rad_s[j] = m.motor_velocity_rad_s();
  sensors->motor_current_A[j] = c.direction * m.iq_A;
  sensors->torque_Nm[j] =
      c.torque_efficiency * c.gear_ratio * c.torque_constant_Nm_A * sensors->motor_current_A[j];
  sensors->declared_payload_kg[j] = c.declared_payload_kg;
  if (c.output) {
    sensors->chamber_pressure_bar[j] = m.sensors.chamber_pressure_bar;
    sensors->reservoir_pressure_bar[j] = m.sensors.reservoir_pressure_bar;
    sensors->load_force_N[j] = m.sensors.load_force_N;
    sensors->motor_temperature_degC[j] = m.sensors.motor_temperature_degC;
    sensors->valve_open[j] = m.output.valve_open;
  }
  const std::int64_t age_us =
      std::clamp<std::int64_t>((now_ns - m.oldest_ns()) / 1000, 0, 2'000'000'000);
  sensors->age_us[j] = static_cast<std::int32_t>(age_us);
  sensors->valid[j] = age_us * 1000 <= ToNs(timing_.estimate_timeout_s);
  (void)fault_.Report();
  sensors->joint_fault[j] = fault_.fault();
  sensors->joint_fault[j].joint = static_cast<int>(j);
}

}  // namespace sinew::bridge
