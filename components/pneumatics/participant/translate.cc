#include "components/pneumatics/participant/translate.h"

#include "components/wire/wire.h"

namespace sinew::pneumatics {
namespace {

msg::PneumaticMode ToMessage(Mode mode) {
  switch (mode) {
    case Mode::kHold:
      return msg::PNEUMATIC_HOLD;
    case Mode::kFill:
      return msg::PNEUMATIC_FILL;
    case Mode::kVent:
      return msg::PNEUMATIC_VENT;
    case Mode::kSafe:
      return msg::PNEUMATIC_SAFE;
    case Mode::kIdle:
      break;
  }
  return msg::PNEUMATIC_IDLE;
}

}  // namespace

RobotPneumatics::RobotPneumatics(node::Node& node, node::TickLoop& loop,
                                 const PneumaticsConfig& config)
    : config_(config),
      state_(loop.AddInput(node::kJointState)),
      actuator_(loop.AddInput(node::kActuatorState)),
      requests_(node.MakeReader(node::kStiffnessRequest)),
      operator_(node.MakeReader(node::kOperatorCommand)) {
  for (std::size_t j = 0; j < config.joints.size(); ++j) {
    managers_.emplace_back(config.joints[j]);
    standing_target_bar_[j] = config.joints[j].target_bar;
  }
  // The requester publishes in every tick; one tick late, so that lockstep has no loop.
  if (config.motion_requests) {
    motion_ = &loop.AddInput(node::kMotionRequest, {.delay_ticks = 1, .required = true});
  }
}

void RobotPneumatics::TakeRequests(const node::Tick& tick) {
  while (const auto request = requests_.TakeNext()) {
    if (request->header().session_id() != tick.session_id) continue;
    for (std::size_t j = 0; j < managers_.size() && j < request->joint_count(); ++j) {
      PressureManager& manager = managers_[j];
      bool good = true;
      if (request->kind()[j] == msg::STIFFNESS_PRESSURE) {
        good = manager.RequestPressure(request->pressure_bar()[j]);
      } else if (request->kind()[j] == msg::STIFFNESS_SECANT) {
        good = manager.RequestStiffness(request->stiffness_Nm_rad()[j]);
      } else {
        continue;
      }
      if (good) standing_target_bar_[j] = manager.target_bar();
    }
  }
  const bool asked = motion_ != nullptr && motion_->has_value() &&
                     static_cast<double>(tick.tick - motion_->tick()) * tick.nominal_period_s <=
                         config_.motion_timeout_s;
  for (std::size_t j = 0; j < managers_.size(); ++j) {
    double target_bar = standing_target_bar_[j];
    if (asked && j < motion_->value().joint_count() &&
        wire::FromWire(motion_->value().kind()[j]) != types::Motion::kNone &&
        motion_->value().pressure_bar()[j] > 0.0) {
      target_bar = motion_->value().pressure_bar()[j];
    }
    managers_[j].RequestPressure(target_bar);
  }
  while (const auto command = operator_.TakeNext()) {
    const auto action = wire::FromWire(command->action());
    if (action == types::OperatorAction::kEstop) estopped_ = true;
    const bool ours = command->header().session_id() == tick.session_id;
    if (action == types::OperatorAction::kReset && ours) {
      estopped_ = false;
      reset_ = true;
    }
  }
}

void RobotPneumatics::Step(const node::Tick& tick) {
  if (tick.session_id != session_id_) {
    session_id_ = tick.session_id;
    estopped_ = false;
    for (std::size_t j = 0; j < managers_.size(); ++j) {
      managers_[j].Restart();
      standing_target_bar_[j] = config_.joints[j].target_bar;
    }
  }
  reset_ = false;
  TakeRequests(tick);
  const msg::JointState& state = state_.value();
  const types::RobotState robot_state = wire::FromWire(state.robot_state());
  const bool armed = types::MayMove(robot_state);
  const bool quiet = robot_state == types::RobotState::kDisarmed && config_.hold_disarmed;
  for (std::size_t j = 0; j < managers_.size(); ++j) {
    ManagerInput input;
    input.period_s = tick.period_s;
    input.active = (armed || quiet) && !estopped_;
    input.reset = reset_;
    if (actuator_.fresh() && j < actuator_.value().joint_count()) {
      const msg::ActuatorState& inside = actuator_.value();
      input.valid = inside.valid()[j];
      input.chamber_bar = inside.chamber_pressure_bar()[j];
      input.reservoir_bar = inside.reservoir_pressure_bar()[j];
      input.valve_is_open = inside.valve_open()[j];
    }
    output_[j] = managers_[j].Step(input);
  }
}

msg::ValveCommand RobotPneumatics::Command() const {
  msg::ValveCommand message;
  message.joint_count(static_cast<std::uint8_t>(managers_.size()));
  for (std::size_t j = 0; j < managers_.size(); ++j) {
    message.valve_open()[j] = output_[j].valve_open;
    message.compressor_on()[j] = output_[j].compressor_on;
    message.vent_open()[j] = output_[j].vent_open;
  }
  return message;
}

msg::PneumaticState RobotPneumatics::State(const node::Tick& tick) const {
  msg::PneumaticState message;
  message.state_tick(tick.tick);
  message.joint_count(static_cast<std::uint8_t>(managers_.size()));
  for (std::size_t j = 0; j < managers_.size(); ++j) {
    const ManagerOutput& out = output_[j];
    message.mode()[j] = ToMessage(out.mode);
    message.target_pressure_bar()[j] = out.target_bar;
    message.pressure_bar()[j] = out.pressure_bar;
    message.stiffness_Nm_rad()[j] = out.stiffness_Nm_rad;
    message.settled()[j] = out.settled;
    message.sensor_fault()[j] = out.sensor_fault;
  }
  return message;
}

std::string RobotPneumatics::Trouble() const {
  for (std::size_t j = 0; j < managers_.size(); ++j) {
    if (output_[j].fault == Fault::kNone) continue;
    return "joint " + std::to_string(j) + ": " + FaultText(output_[j].fault);
  }
  return "";
}

}  // namespace sinew::pneumatics
