#include "components/robot/control/participant/translate.h"

#include <algorithm>

#include "components/base/types/joints.h"
#include "components/base/types/operator_action.h"
#include "components/base/types/robot_state.h"
#include "components/base/types/state_archive.h"
#include "components/topics/node/codec.h"

namespace sinew::control {
namespace {

bool AllPosition(const ControlConfig& config) {
  return std::all_of(
      config.joints.begin(), config.joints.end(),
      [](const JointControlConfig& joint) { return joint.strategy == Strategy::kPosition; });
}

double Late_s(const node::Tick& tick, std::uint64_t of_tick) {
  return of_tick >= tick.tick ? 0.0
                              : static_cast<double>(tick.tick - of_tick) * tick.nominal_period_s;
}

// The tick of what a prediction was computed from: one that went on with an older reference says so
// by being stale. Tick 0: its predictor lacked something else.
std::uint64_t PredictedFrom(const msg::TorquePrediction& prediction) {
  const std::uint64_t own = prediction.header.tick;
  if (!prediction.stale) return own;
  return prediction.reference_tick < own ? prediction.reference_tick : 0;
}

}  // namespace

ControlInputs::ControlInputs(node::Node& node, node::TickLoop& loop, const ControlConfig& config)
    : loop_(loop),
      config_(config),
      state_(loop.AddInput(node::kJointState)),
      reference_(loop.AddInput(node::kReference)),
      operator_(node.MakeReader(node::kOperatorCommand)),
      owner_(node, node::kJointCommand) {
  const bool motion = config.motion_requests != MotionRequests::kOff;
  if (!AllPosition(config) || motion) actuator_ = &loop.AddInput(node::kActuatorState);
  if (config.needs_prediction()) prediction_ = &loop.AddInput(node::kTorquePrediction);
  if (config.needs_regime()) regime_ = &loop.AddInput(node::kRegime);
  if (motion) {
    const bool every_tick = config.motion_requests == MotionRequests::kEveryTick;
    motion_ = &loop.AddInput(node::kMotionRequest,
                             {.delay_ticks = every_tick ? 1 : 0, .required = every_tick});
  }
}

void ControlInputs::TakeOperatorCommands(const node::Tick& tick) {
  while (const auto command = operator_.TakeNext()) {
    const types::OperatorAction action = command->action;
    const bool stops = action == types::OperatorAction::kEstop;
    const bool resets = action == types::OperatorAction::kReset &&
                        reset_gate_.Admits(types::CommandKind::kPermission, command->header,
                                           {tick.session_id, state_.value().header.origin});
    if (!stops && !resets) continue;
    estopped_ = stops;
    loop_.Used(node::EventId(*command));
  }
}

RobotInput ControlInputs::Gather(const node::Tick& tick) {
  TakeOperatorCommands(tick);
  const msg::JointState& state = state_.value();
  RobotInput input;
  input.session_id = tick.session_id;
  input.period_s = tick.period_s;
  const types::RobotState robot_state = state.robot_state;
  input.interrupted = robot_state == types::RobotState::kDamped || !tick.settled;
  input.stands_by = stands_by_;
  input.armed = !estopped_ && types::MayMove(robot_state);
  input.joint_count = std::min<int>(state.joint_count, types::kMaxJoints);
  for (std::size_t j = 0; j < static_cast<std::size_t>(input.joint_count); ++j) {
    MeasuredJointState& m = input.joint[j];
    m.valid = state.valid[j];
    m.position_rad = state.position_rad[j];
    m.velocity_rad_s = state.velocity_rad_s[j];
    if (actuator_ == nullptr || !actuator_->fresh()) continue;
    const msg::ActuatorState& inside = actuator_->value();
    m.actuator_valid = j < inside.joint_count && inside.valid[j];
    m.motor_position_rad = inside.motor_position_rad[j];
    m.motor_velocity_rad_s = inside.motor_velocity_rad_s[j];
    m.pressure_bar = inside.chamber_pressure_bar[j];
    m.load_force_N = inside.load_force_N[j];
    m.payload_kg = inside.declared_payload_kg[j];
    m.temperature_degC = inside.motor_temperature_degC[j];
    m.valve_open = inside.valve_open[j];
  }

  if (reference_.has_value()) {
    const msg::Reference& reference = reference_.value();
    input.reference_fresh = reference_.fresh() && !reference.stale;
    if (!reference.stale) input.reference_late_s = Late_s(tick, reference_.tick());
    input.reference_changed = reference_.writer_changed();
    input.reference_replayed = tick.replay_permitted;
    input.reference_count = reference.idle ? 0 : reference.joint_count;
    for (std::size_t j = 0; j < static_cast<std::size_t>(types::kMaxJoints); ++j) {
      input.reference[j] = {reference.position_rad[j], reference.velocity_rad_s[j],
                            reference.acceleration_rad_s2[j]};
    }
  }
  if (prediction_ != nullptr && prediction_->has_value()) {
    const msg::TorquePrediction& prediction = prediction_->value();
    input.prediction_fresh = prediction_->fresh() && !prediction.stale;
    input.prediction_late_s = Late_s(tick, PredictedFrom(prediction));
    input.prediction_changed = prediction_->writer_changed();
    for (std::size_t j = 0; j < prediction.joint_count; ++j) {
      input.prediction[j] = {prediction.valid[j], prediction.sea_torque_Nm[j],
                             prediction.pea_torque_Nm[j], prediction.torque_Nm[j]};
    }
  }
  if (regime_ != nullptr && regime_->has_value()) {
    const msg::RegimeState& regime = regime_->value();
    input.regime_fresh = regime_->fresh() && !regime.stale;
    if (!regime.stale) input.regime_late_s = Late_s(tick, regime_->tick());
    for (std::size_t j = 0; j < regime.joint_count; ++j) {
      input.regime[j] = regime.regime[j];
    }
  }
  if (motion_ != nullptr && motion_->has_value()) {
    const double age_s = static_cast<double>(tick.tick - motion_->tick()) * tick.nominal_period_s;
    if (age_s <= config_.motion_timeout_s) {
      const msg::MotionRequest& request = motion_->value();
      for (std::size_t j = 0; j < request.joint_count; ++j) {
        input.motion[j] = {request.kind[j], request.target_rad[j], request.velocity_limit_rad_s[j],
                           request.motor_torque_limit_Nm[j]};
      }
    }
  }
  return input;
}

void ControlInputs::FollowOwner(const node::Tick& tick, RobotController* controller) {
  while (const auto command = owner_.TakeNext(tick)) {
    const auto difference = follower_.Compare(command->header.session_id, command->header.tick,
                                              command->motor_torque_Nm);
    if (difference) controller->Follow(*difference);
  }
  // A controller that has just begun may not know yet that another one is obeyed.
  stands_by_ = owner_.StandsBy(tick) || !tick.settled;
}

void ControlInputs::Made(const node::Tick& tick, const msg::JointCommand& command) {
  follower_.Made(tick.session_id, tick.tick, command.motor_torque_Nm);
}

msg::JointCommand ControlInputs::ToMessage(const RobotOutput& output,
                                           const RobotInput& input) const {
  msg::JointCommand message;
  message.stale = output.stale && input.armed;
  message.joint_count = static_cast<std::uint8_t>(output.joint_count);
  for (std::size_t j = 0; j < static_cast<std::size_t>(output.joint_count); ++j) {
    const JointOutput& joint = output.joint[j];
    message.mode[j] = joint.mode;
    message.motor_torque_Nm[j] = joint.motor_torque_Nm;
    message.position_rad[j] = joint.position_rad;
    message.velocity_rad_s[j] = joint.velocity_rad_s;
  }
  return message;
}

void ControlInputs::Exchange(types::StateArchive& archive) {
  archive(follower_, estopped_, stands_by_);
}

std::string FaultLine(const RobotOutput& output) {
  if (output.fault == Fault::kNone) return "";
  if (output.fault == Fault::kOtherRobot) return FaultText(output.fault);
  return "joint " + std::to_string(output.fault_joint) + ": " + FaultText(output.fault);
}

}  // namespace sinew::control
