#include "components/robot/control/joint_controller.h"

#include <cmath>
#include <stdexcept>

#include "components/base/types/control_mode.h"
#include "components/base/types/require.h"
#include "components/robot/reference/blend.h"

namespace sinew::control {
using types::Require;

namespace {

bool Finite(const Point& p) noexcept {
  return std::isfinite(p.position_rad) && std::isfinite(p.velocity_rad_s) &&
         std::isfinite(p.acceleration_rad_s2);
}

bool ActuatorFinite(const MeasuredJointState& m) noexcept {
  return std::isfinite(m.motor_position_rad) && std::isfinite(m.motor_velocity_rad_s) &&
         std::isfinite(m.pressure_bar) && std::isfinite(m.load_force_N) &&
         std::isfinite(m.payload_kg) && std::isfinite(m.temperature_degC);
}

bool SameOrder(const MotionOrder& a, const MotionOrder& b) noexcept {
  return a.kind == b.kind && a.target_rad == b.target_rad &&
         a.velocity_limit_rad_s == b.velocity_limit_rad_s;
}

bool Executable(const MotionOrder& order) noexcept {
  if (order.kind == types::Motion::kNone) return false;
  if (!(order.motor_torque_limit_Nm >= 0.0) || !std::isfinite(order.motor_torque_limit_Nm))
    return false;
  if (order.kind == types::Motion::kHold) return true;
  return std::isfinite(order.target_rad) && std::isfinite(order.velocity_limit_rad_s) &&
         order.velocity_limit_rad_s > 0.0;
}

}  // namespace

const char* FaultText(Fault fault) noexcept {
  switch (fault) {
    case Fault::kNone:
      return "none";
    case Fault::kNonFiniteState:
      return "a measured position or velocity is not a number";
    case Fault::kNonFiniteReference:
      return "the reference is not a number";
    case Fault::kNonFiniteOutput:
      return "the command came out as not a number";
    case Fault::kOtherRobot:
      return "the robot has another number of joints than the configuration";
    case Fault::kTrackingError:
      return "the joint is further from its reference than allowed";
    case Fault::kNonFinitePrediction:
      return "the torque prediction is not a number: left out";
  }
  return "unknown";
}

JointController::JointController(const JointControlConfig& config)
    : config_(config), pid_(config.pid) {
  Require(config.gear_ratio > 0.0, "gear ratio", config.gear_ratio, "above 0");
  Require(config.shaft_per_output > 0.0, "motor torque per output torque", config.shaft_per_output,
          "above 0");
  Require(config.motor_torque_limit_Nm > 0.0, "motor torque limit", config.motor_torque_limit_Nm,
          "above 0");
  Require(config.takeover_s >= 0.0, "take-over time", config.takeover_s, "at least 0");
  Require(config.replay_takeover_s >= 0.0, "take-over time of a replay", config.replay_takeover_s,
          "at least 0");
  Require(config.crossfade_s >= 0.0, "cross-fade time", config.crossfade_s, "at least 0");
  Require(config.tracking_error_limit_rad >= 0.0, "tracking error limit",
          config.tracking_error_limit_rad, "at least 0");
  Require(config.damping_Nm_s_rad >= 0.0, "damping", config.damping_Nm_s_rad, "at least 0");
  Require(config.motion_acceleration_rad_s2 > 0.0, "motion acceleration",
          config.motion_acceleration_rad_s2, "above 0");
  Require(config.stale_grace_s >= 0.0, "grace", config.stale_grace_s, "at least 0");
  if (config.strategy == Strategy::kPidLinear) {
    if (!config.model) throw std::invalid_argument("pid_linear needs a model");
    compensator_.emplace(*config.model, config.compensator);
  }
  if (config.strategy == Strategy::kComputedTorque) {
    Require(config.pid.integral_Nm_rad_s == 0.0, "integral gain of computed_torque",
            config.pid.integral_Nm_rad_s, "0");
  }
}

void JointController::Disarm() noexcept {
  started_ = false;
  latched_ = Fault::kNone;
  aim_ = Aim::kNone;
  last_reference_.Forget();
  last_prediction_.Forget();
  last_regime_.Forget();
  last_position_known_ = false;
  source_ = 0;
  feed_forward_Nm_ = fade_Nm_ = integral_alone_Nm_ = 0.0;
  motion_ = {};
  move_.reset();
  pid_.Reset();
  if (compensator_) compensator_->Reset();
}

void JointController::Follow(double difference_motor_torque_Nm) noexcept {
  if (!started_ || !std::isfinite(difference_motor_torque_Nm)) return;
  if (config_.pid.integral_Nm_rad_s == 0.0) return;
  pid_.Shift(difference_motor_torque_Nm / config_.shaft_per_output);
}

double JointController::MeasuredVelocity(const MeasuredJointState& m, double period_s) noexcept {
  double velocity_rad_s = m.velocity_rad_s;
  if (config_.velocity_from == VelocityFrom::kMotor && m.actuator_valid) {
    velocity_rad_s = m.motor_velocity_rad_s / config_.gear_ratio;
  } else if (config_.velocity_from == VelocityFrom::kOutputDifference && last_position_known_) {
    velocity_rad_s = (m.position_rad - last_position_rad_) / period_s;
  }
  last_position_rad_ = m.position_rad;
  last_position_known_ = true;
  return velocity_rad_s;
}

JointOutput JointController::Damping(const MeasuredJointState& m) const noexcept {
  JointOutput output;
  output.mode = types::ControlMode::kTorque;
  double velocity_rad_s = 0.0;
  if (m.actuator_valid && std::isfinite(m.motor_velocity_rad_s)) {
    velocity_rad_s = m.motor_velocity_rad_s / config_.gear_ratio;
  } else if (m.valid && std::isfinite(m.velocity_rad_s)) {
    velocity_rad_s = m.velocity_rad_s;
  }
  output.motor_torque_Nm =
      std::clamp(-config_.damping_Nm_s_rad * config_.shaft_per_output * velocity_rad_s,
                 -config_.motor_torque_limit_Nm, config_.motor_torque_limit_Nm);
  // The position of a lost joint may be anything.
  output.position_rad = std::isfinite(m.position_rad) ? m.position_rad : target_.position_rad;
  return output;
}

void JointController::BridgeLateInputs(JointInput* input) noexcept {
  const double grace_s = config_.stale_grace_s, period_s = input->period_s;
  const auto age_s = [](bool fresh, double late_s) { return fresh ? 0.0 : late_s; };

  const bool was_lost = last_reference_.late_s() > grace_s;
  const bool came = last_reference_.Take(
      input->reference, age_s(input->reference_fresh, input->reference_late_s), period_s);
  // After a loss it is taken up like another generator's.
  input->reference_changed |= came && was_lost;
  const bool follows = came || aim_ == Aim::kReference;
  if (!input->reference_fresh && follows && last_reference_.Within(grace_s)) {
    input->reference = reference::Extrapolated(last_reference_.value(), last_reference_.late_s());
    input->reference_fresh = true;
  }
  last_prediction_.Take(input->prediction, age_s(input->prediction_fresh, input->prediction_late_s),
                        period_s);
  if (!input->prediction_fresh) {
    input->prediction_fresh = last_prediction_.Within(grace_s);
    input->prediction = last_prediction_.value();
  }
  last_regime_.Take(input->regime, age_s(input->regime_fresh, input->regime_late_s), period_s);
  if (!input->regime_fresh) {
    input->regime = last_regime_.Within(grace_s) ? last_regime_.value() : types::Regime::kUnknown;
  }
}

void JointController::ChooseAim(const JointInput& input) noexcept {
  const double position_rad = input.measured->position_rad;
  if (input.reference_expected) {
    if (!input.reference_fresh) return;  // stays with what it did
    if (aim_ != Aim::kReference || input.reference_changed ||
        input.reference_replayed != replayed_) {
      // The target that was followed has gone on since the last cycle.
      const double from_rad = aim_ == Aim::kPush
                                  ? position_rad
                                  : reference::Extrapolated(target_, input.period_s).position_rad;
      offset_rad_ = from_rad - input.reference.position_rad;
      offset_age_s_ = 0.0;
      replayed_ = input.reference_replayed;
      offset_fades_s_ = replayed_ ? config_.replay_takeover_s : config_.takeover_s;
      aim_ = Aim::kReference;
    }
    return;
  }
  const MotionOrder& order = input.motion;
  if (Executable(order)) {
    const bool moving = aim_ == Aim::kMove || aim_ == Aim::kPush;
    const bool known = SameOrder(order, motion_) &&
                       (moving || (aim_ == Aim::kHold && order.kind == types::Motion::kHold));
    const double from_rad = aim_ == Aim::kPush ? position_rad : target_.position_rad;
    motion_ = order;
    if (known) return;
    target_ = {from_rad, 0.0, 0.0};
    if (order.kind == types::Motion::kHold) {
      aim_ = Aim::kHold;
    } else if (order.kind == types::Motion::kMoveSlowly) {
      aim_ = Aim::kMove;
      move_.emplace(reference::MoveConfig{from_rad, order.target_rad, order.velocity_limit_rad_s,
                                          config_.motion_acceleration_rad_s2});
      move_age_s_ = 0.0;
    } else if (aim_ != Aim::kPush) {
      aim_ = Aim::kPush;
      push_at_rad_ = last_actuator_.motor_position_rad / config_.gear_ratio;
      pid_.Reset();
    }
    return;
  }
  if (aim_ == Aim::kHold && motion_.kind == types::Motion::kNone) return;
  if (aim_ != Aim::kHold) {  // reference or motion ended: hold where the joint is
    target_ = {aim_ == Aim::kMove ? target_.position_rad : position_rad, 0.0, 0.0};
    aim_ = Aim::kHold;
  }
  motion_ = {};
}

Point JointController::Target(const JointInput& input) noexcept {
  if (aim_ == Aim::kReference) {
    if (!input.reference_fresh) return {target_.position_rad, 0.0, 0.0};
    const reference::BlendWeight w = reference::Blend(offset_age_s_, offset_fades_s_);
    offset_age_s_ += input.period_s;
    return {input.reference.position_rad + offset_rad_ * (1.0 - w.value),
            input.reference.velocity_rad_s - offset_rad_ * w.rate_per_s,
            input.reference.acceleration_rad_s2 - offset_rad_ * w.curvature_per_s2};
  }
  if (aim_ == Aim::kMove) {
    move_age_s_ += input.period_s;
    return move_->At(move_age_s_);
  }
  return {target_.position_rad, 0.0, 0.0};
}

bool JointController::PredictionCounts(const JointInput& input) const noexcept {
  if (aim_ == Aim::kReference) return input.reference_fresh;
  return config_.strategy == Strategy::kComputedTorque && aim_ == Aim::kHold;
}

double JointController::FeedForward(const JointInput& input, const Point& target) noexcept {
  int source = 0;
  double wanted_Nm = 0.0;
  const bool recorded = config_.compensator.kind == CompensatorKind::kRecorded;
  if (config_.strategy == Strategy::kPidLinear && (!recorded || aim_ == Aim::kReference)) {
    source = 1;
    MeasuredJointState m = last_actuator_;
    m.actuator_valid = input.measured->actuator_valid;
    wanted_Nm = compensator_->Step(target, m, input.period_s);
  } else if (UsesPrediction(config_.strategy) && input.prediction_fresh && input.prediction.valid &&
             PredictionCounts(input)) {
    const JointPrediction& prediction = input.prediction;
    if (!config_.needs_regime()) {
      source = 4;
      wanted_Nm = config_.shaft_per_output * prediction.torque_Nm;
    } else if (input.regime == types::Regime::kSea) {
      source = 2;
      wanted_Nm = config_.shaft_per_output * prediction.sea_torque_Nm;
    } else if (input.regime == types::Regime::kPea) {
      source = 3;
      wanted_Nm = config_.shaft_per_output * prediction.pea_torque_Nm;
    }
  }
  if (source != source_ || (source >= 2 && input.prediction_changed)) {
    fade_Nm_ = feed_forward_Nm_ - wanted_Nm;
    if (source == 0) {
      integral_alone_Nm_ = pid_.integral_Nm();
    } else if (source_ == 0) {  // what the integral took over from the feed-forward, it gives back
      const double instead_Nm = wanted_Nm / config_.shaft_per_output;
      const double held_Nm = std::clamp(pid_.integral_Nm() - integral_alone_Nm_,
                                        std::min(0.0, instead_Nm), std::max(0.0, instead_Nm));
      pid_.Shift(-held_Nm);
      fade_Nm_ += config_.shaft_per_output * held_Nm;
    }
    source_ = source;
  }
  fade_Nm_ *= config_.crossfade_s > 0.0 ? std::exp(-input.period_s / config_.crossfade_s) : 0.0;
  feed_forward_Nm_ = wanted_Nm + fade_Nm_;
  return feed_forward_Nm_;
}

// The motor turns toward the target at the velocity limit, pushing no harder than allowed: a PID on
// the motor's own angle whose target waits when the torque is at its limit.
JointOutput JointController::Push(const JointInput& input) noexcept {
  const MeasuredJointState& m = *input.measured;
  if (!m.actuator_valid) return Damping(m);
  const double motor_rad = m.motor_position_rad / config_.gear_ratio;
  const double motor_rad_s = m.motor_velocity_rad_s / config_.gear_ratio;
  const double step_rad = motion_.velocity_limit_rad_s * input.period_s;
  const double way_rad = std::clamp(motion_.target_rad - push_at_rad_, -step_rad, step_rad);
  push_at_rad_ += way_rad;
  const double wanted_Nm =
      config_.shaft_per_output *
      pid_.Step(push_at_rad_ - motor_rad, way_rad / input.period_s - motor_rad_s, input.period_s);
  JointOutput output;
  SetTorque(wanted_Nm, &output);
  if (output.saturated) {
    push_at_rad_ -= way_rad;  // waits for the motor
    pid_.Limited((output.motor_torque_Nm - wanted_Nm) / config_.shaft_per_output, input.period_s);
  }
  output.position_rad = push_at_rad_;
  feed_forward_Nm_ = fade_Nm_ = 0.0;
  source_ = 0;
  target_ = {m.position_rad, 0.0, 0.0};
  return output;
}

void JointController::SetTorque(double wanted_Nm, JointOutput* output) const noexcept {
  double limit_Nm = config_.motor_torque_limit_Nm;
  const bool ordered = aim_ == Aim::kMove || aim_ == Aim::kPush;
  if (ordered && motion_.motor_torque_limit_Nm > 0.0) {
    limit_Nm = std::min(limit_Nm, motion_.motor_torque_limit_Nm);
  }
  output->mode = types::ControlMode::kTorque;
  output->motor_torque_Nm = std::clamp(wanted_Nm, -limit_Nm, limit_Nm);
  output->saturated = output->motor_torque_Nm != wanted_Nm;
}

JointController::Result JointController::Step(const JointInput& input) noexcept {
  Result result;
  if (latched_ == Fault::kNone) latched_ = Command(input, &result);
  if (latched_ == Fault::kNone) return result;
  result.fault = latched_;
  result.output = JointOutput{};
  result.output.position_rad = target_.position_rad;
  return result;
}

Fault JointController::Command(const JointInput& input, Result* result) noexcept {
  MeasuredJointState m = *input.measured;
  if (m.actuator_valid && !ActuatorFinite(m)) {
    m.actuator_valid = false;
    result->stale = true;
  }
  if (m.valid && !(std::isfinite(m.position_rad) && std::isfinite(m.velocity_rad_s))) {
    return Fault::kNonFiniteState;
  }
  if (input.reference_expected && input.reference_fresh && !Finite(input.reference)) {
    return Fault::kNonFiniteReference;
  }
  if (!(input.period_s > 0.0)) return Fault::kNonFiniteState;
  if (m.actuator_valid) last_actuator_ = m;
  if (!m.valid) {  // where it is is not known: nothing to regulate
    result->output = Damping(m);
    result->stale = true;
    last_position_known_ = false;
    return Fault::kNone;
  }
  if (!m.actuator_valid &&
      (config_.velocity_from == VelocityFrom::kMotor || config_.strategy == Strategy::kPidLinear)) {
    result->stale = true;  // goes on with output velocity and the last pressure
  }
  const bool rests = aim_ == Aim::kHold && motion_.kind == types::Motion::kNone;
  if (!started_ || (input.stands_by && rests)) {
    started_ = true;
    target_ = {m.position_rad, 0.0, 0.0};
    aim_ = Aim::kHold;
  }

  JointInput now = input;
  now.measured = &m;
  BridgeLateInputs(&now);
  const Aim before_aim = aim_;
  ChooseAim(now);
  if (before_aim == Aim::kPush && aim_ != Aim::kPush) pid_.Reset();  // it was the motor's own
  if (input.reference_expected && !input.reference_fresh) result->stale = true;
  JointOutput& output = result->output;
  if (aim_ == Aim::kPush) {
    output = Push(now);
    const bool finite = std::isfinite(output.motor_torque_Nm) && std::isfinite(output.position_rad);
    return finite ? Fault::kNone : Fault::kNonFiniteOutput;
  }

  const Point target = Target(now);
  // A finite reference far away and the step to it may add up to more than a number holds.
  if (!Finite(target)) return Fault::kNonFiniteReference;
  target_ = target;
  const double velocity_rad_s = MeasuredVelocity(m, input.period_s);
  if (config_.tracking_error_limit_rad > 0.0 && aim_ == Aim::kReference &&
      std::abs(target_.position_rad - m.position_rad) > config_.tracking_error_limit_rad) {
    if (!input.stands_by) return Fault::kTrackingError;
    // Another one moves the joint: the error is not of these commands. After a stop of this process
    // it is that of an old target. The reference is taken up anew, from where the joint is.
    target_ = {m.position_rad, 0.0, 0.0};
    aim_ = Aim::kHold;
  }
  output.position_rad = target_.position_rad;
  output.velocity_rad_s = target_.velocity_rad_s;
  if (config_.strategy == Strategy::kPosition) {
    output.mode = types::ControlMode::kPosition;
    return Fault::kNone;
  }
  if (input.reference_expected && !now.reference_fresh && config_.on_stale == OnStale::kDamp) {
    output = Damping(m);
    return Fault::kNone;
  }
  if (UsesPrediction(config_.strategy) && now.prediction_fresh && now.prediction.valid &&
      !(std::isfinite(now.prediction.sea_torque_Nm) &&
        std::isfinite(now.prediction.pea_torque_Nm) && std::isfinite(now.prediction.torque_Nm))) {
    now.prediction.valid = false;
    result->fault = Fault::kNonFinitePrediction;
    result->stale = true;
  }
  return Regulate(now, velocity_rad_s, &output);
}

Fault JointController::Regulate(const JointInput& input, double velocity_rad_s,
                                JointOutput* output) noexcept {
  output->compensation_Nm = FeedForward(input, target_);
  const Pid before = pid_;
  const double error_rad = target_.position_rad - input.measured->position_rad;
  const double rate_rad_s =
      (config_.derivative_of == DerivativeOf::kError ? target_.velocity_rad_s : 0.0) -
      velocity_rad_s;
  const double feedback_Nm =
      config_.shaft_per_output * pid_.Step(error_rad, rate_rad_s, input.period_s);
  const double wanted_Nm = feedback_Nm + output->compensation_Nm;
  if (!std::isfinite(wanted_Nm)) return Fault::kNonFiniteOutput;
  SetTorque(wanted_Nm, output);
  if (input.interrupted) {
    pid_ = before;  // the robot did not get these commands: nothing to learn from their errors
  } else if (output->saturated) {
    pid_.Limited((output->motor_torque_Nm - wanted_Nm) / config_.shaft_per_output, input.period_s);
  }
  return Fault::kNone;
}

}  // namespace sinew::control
