#include "components/robot/provider/provider_cycle.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "components/base/types/seconds.h"

namespace sinew::provider {

using types::ControlMode;
using types::Fault;
using types::FaultCause;
using types::kMaxJoints;
using types::OperatorAction;
using types::Origin;
using types::RobotState;

std::uint64_t SessionFromSeed(std::uint64_t seed) noexcept {
  std::uint64_t z = seed + 0x9E3779B97F4A7C15ull;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
  return (z ^ (z >> 31)) | 1u;
}

ProviderCycle::ProviderCycle(const CycleConfig& config) : config_(config), guard_(config.guard) {
  if (config.joint_count < 1 || config.joint_count > kMaxJoints) {
    throw std::invalid_argument(std::to_string(config.joint_count) + " joints, expected 1 to " +
                                std::to_string(kMaxJoints));
  }
  if (!(config.rate_Hz > 0.0) || !std::isfinite(config.rate_Hz)) {
    throw std::invalid_argument("a rate of " + std::to_string(config.rate_Hz) +
                                " Hz, expected above 0");
  }
  if (config.guard.fall != nullptr) {
    const FallGuardConfig& fall = *config.guard.fall;
    if (fall.joint_count != config.joint_count) {
      throw std::invalid_argument("the fall guard's robot has " + std::to_string(fall.joint_count) +
                                  " joints, expected " + std::to_string(config.joint_count));
    }
    fall_.emplace(fall, 1.0 / config.rate_Hz);
  }
  guard_.StartSession(config.session_id);
  (void)types::ToNanoseconds(1.0 / config.rate_Hz);  // throws where it has no nanoseconds
  (void)types::ToNanoseconds(config.duration_s);
  period_ = std::chrono::nanoseconds(std::llround(1e9 / config.rate_Hz));
  period_s_ = 1.0 / config.rate_Hz;
  if (config.duration_s > 0.0) {
    last_tick_ = static_cast<std::uint64_t>(std::llround(config.duration_s * config.rate_Hz)) - 1;
  }
}

bool ProviderCycle::AnsweredForArming(std::uint64_t tick) const {
  if (!config_.arm_needs_answers) return true;
  const std::int64_t old = static_cast<std::int64_t>(tick - joint_answers_);  // -1: of this tick
  return joint_answers_ > 0 && old * period_ <= config_.guard.fault_after;
}

bool ProviderCycle::ArmAtStart(std::uint64_t tick) {
  if (!config_.plant_may_be_armed) return false;
  if (!AnsweredForArming(tick) || CommandFault().active()) return false;
  return guard_.Arm(config_.session_id, tick);
}

OperatorResult ProviderCycle::Take(const OperatorCommand& command, std::uint64_t tick) {
  if (command.action == OperatorAction::kArm || command.action == OperatorAction::kReset) {
    switch (types::RefusalOf(types::KindOf(command.action),
                             {.session_id = command.session_id, .origin = command.origin},
                             running())) {
      case types::CommandRefusal::kNone:
        break;
      case types::CommandRefusal::kOtherSession:
        return OperatorResult::kRefusedOtherSession;
      case types::CommandRefusal::kOrigin:
        return OperatorResult::kRefusedOrigin;
    }
  }
  switch (command.action) {
    case OperatorAction::kArm:
      if (!config_.plant_may_be_armed) return OperatorResult::kRefusedByPlant;
      if (CommandFault().cause != FaultCause::kNone) return OperatorResult::kRefusedByCommand;
      if (!estops_watched_) return OperatorResult::kRefusedByEstop;
      if (state() == RobotState::kDisarmed && !AnsweredForArming(tick)) {
        return OperatorResult::kRefusedUnanswered;
      }
      if (fall_ && state() == RobotState::kDisarmed && !fall_->upright()) {
        return OperatorResult::kRefusedByFallGuard;
      }
      return guard_.Arm(command.session_id, tick) ? OperatorResult::kDone
                                                  : OperatorResult::kRefusedResetFirst;
    case OperatorAction::kDisarm:
      guard_.Disarm();
      return OperatorResult::kDone;
    case OperatorAction::kEstop:
      guard_.Estop();
      return OperatorResult::kDone;
    case OperatorAction::kReset:
      if (types::MayMove(state())) {
        return OperatorResult::kRefusedDisarmFirst;
      }
      if (state() == RobotState::kEstopped && config_.estop_is_latched) {
        return OperatorResult::kUnlatchFirst;
      }
      ResetFaults();
      guard_.Reset();
      return OperatorResult::kClearFaults;
    case OperatorAction::kStart:
    case OperatorAction::kStop:
    case OperatorAction::kHandover:
    case OperatorAction::kPermitReplay:
      break;
  }
  return OperatorResult::kNotForProvider;
}

bool ProviderCycle::FinishReset() {
  if (state() != RobotState::kEstopped) return false;
  ResetFaults();
  return guard_.Reset();
}

void ProviderCycle::ResetFaults() {
  faulty_joints_ = 0;
  if (fall_ && fall_->fallen()) fall_->Reset();
}

bool ProviderCycle::Take(const JointSetpoints& command, std::uint64_t tick) {
  if (command.header.session_id == config_.session_id) {
    joint_answers_ = command.header.tick + 1;
  }
  if (Admits(command.header)) {
    command_fault_ = FaultOf(command);
    if (command_fault_.cause != FaultCause::kNone) {
      if (types::MayMove(state())) guard_.Fail(command_fault_);
      return false;
    }
  }
  if (!guard_.Offer(command.header, tick)) return false;
  joints_ = command;
  return true;
}

Fault ProviderCycle::FaultOf(const JointSetpoints& command) const {
  if (command.joint_count != config_.joint_count) {
    return {.cause = FaultCause::kCommandJoints,
            .value = static_cast<double>(command.joint_count),
            .limit = static_cast<double>(config_.joint_count)};
  }
  if (!command.other_joint) return {};
  return {.cause = FaultCause::kCommandNames, .joint = *command.other_joint};
}

bool ProviderCycle::Take(const ValveCommand& command, std::uint64_t tick) {
  if (command.header.session_id != config_.session_id) return false;
  if (valves_ && command.header.tick <= valves_->header.tick) return false;  // late
  valve_answers_ = command.header.tick + 1;
  if (command.header.tick > tick) return false;
  if (!Admits(command.header)) return false;
  valves_ = command;
  return true;
}

types::MessageHeader ProviderCycle::Header(std::uint64_t tick, std::int64_t now_ns) const {
  types::MessageHeader header;
  header.session_id = config_.session_id;
  header.tick = tick;
  header.stamp_ns = config_.simulated_time ? static_cast<std::int64_t>(std::llround(
                                                 static_cast<double>(tick) * 1e9 / config_.rate_Hz))
                                           : now_ns;
  header.origin = config_.guard.live ? Origin::kLive : Origin::kSim;
  return header;
}

bool ProviderCycle::Begin(std::uint64_t tick, std::int64_t now_ns) {
  if (!config_.ages_by_clock) return false;
  const std::chrono::nanoseconds gap(now_ns - began_ns_[(tick + kTicksKept - 1) % kTicksKept]);
  began_ns_[tick % kTicksKept] = now_ns;
  if (tick == 0 || gap <= config_.guard.fault_after || !types::MayMove(state())) return false;
  guard_.Fail({.cause = FaultCause::kCycleLate,
               .value = Milliseconds(gap),
               .limit = Milliseconds(config_.guard.fault_after)});
  return true;
}

std::chrono::nanoseconds ProviderCycle::AgeByClock(std::uint64_t tick, std::int64_t now_ns) const {
  if (!config_.ages_by_clock) return std::chrono::nanoseconds(0);
  const std::uint64_t of = guard_.last_tick();
  if (tick - of >= kTicksKept) return std::chrono::nanoseconds::max();
  return std::chrono::nanoseconds(now_ns - began_ns_[of % kTicksKept]);
}

const PlantCommand& ProviderCycle::Command(std::uint64_t tick, const PlantSensors& sensors,
                                           std::int64_t now_ns) {
  Verdict verdict = guard_.Step(tick, period_, AgeByClock(tick, now_ns));
  if (const auto joint = verdict == Verdict::kPass ? NotFinite() : std::nullopt) {
    guard_.Fail({.cause = FaultCause::kCommandNotFinite, .joint = static_cast<int>(*joint)});
    verdict = Verdict::kIdle;
  }
  const bool stopped = state() == RobotState::kFault || state() == RobotState::kEstopped;
  const bool valves_follow = !stopped && ValvesFollow(tick);
  const bool lets_out = stopped && config_.guard.valves_in_fault == ValvesInFault::kVent;
  const auto joints = static_cast<std::size_t>(config_.joint_count);
  for (std::size_t j = 0; j < joints; ++j) {
    command_.motor_torque_Nm[j] = 0.0;
    switch (sensors.joint_fault[j].active() ? Verdict::kIdle : verdict) {
      case Verdict::kIdle:
        command_.mode[j] = ControlMode::kIdle;
        break;
      case Verdict::kPass:
        Pass(j);
        break;
      case Verdict::kHold:
        if (!holding_) {
          held_[j] = std::isfinite(sensors.position_rad[j]);
          if (held_[j]) command_.position_rad[j] = sensors.position_rad[j];
        }
        command_.mode[j] = held_[j] ? ControlMode::kPosition : ControlMode::kIdle;
        command_.velocity_rad_s[j] = 0.0;
        break;
      case Verdict::kDamp:
        command_.mode[j] = ControlMode::kTorque;
        if (std::isfinite(sensors.motor_velocity_rad_s[j])) {
          command_.motor_torque_Nm[j] =
              -config_.guard.damping_Nm_s_rad * sensors.motor_velocity_rad_s[j];
        }
        break;
    }
    const bool follows = valves_follow && static_cast<int>(j) < valves_->joint_count;
    command_.valve_open[j] = lets_out || (follows && valves_->valve_open[j]);
    command_.compressor_on[j] = follows && valves_->compressor_on[j];
    command_.vent_open[j] = lets_out || (follows && valves_->vent_open[j]);
  }
  holding_ = verdict == Verdict::kHold;
  asks_ = verdict == Verdict::kHold || verdict == Verdict::kPass;
  return command_;
}

void ProviderCycle::Pass(std::size_t j) {
  command_.mode[j] = joints_.mode[j];
  command_.motor_torque_Nm[j] = joints_.motor_torque_Nm[j];
  command_.position_rad[j] = joints_.position_rad[j];
  command_.velocity_rad_s[j] = joints_.velocity_rad_s[j];
}

std::optional<std::size_t> ProviderCycle::NotFinite() const {
  for (std::size_t j = 0; static_cast<int>(j) < config_.joint_count; ++j) {
    if (!std::isfinite(joints_.motor_torque_Nm[j]) || !std::isfinite(joints_.position_rad[j]) ||
        !std::isfinite(joints_.velocity_rad_s[j])) {
      return j;
    }
  }
  return std::nullopt;
}

bool ProviderCycle::ValvesFollow(std::uint64_t tick) const {
  if (!valves_) return false;
  const auto age = static_cast<std::int64_t>(tick - valves_->header.tick);
  return age * period_ <= config_.guard.fault_after;
}

FaultChange ProviderCycle::Observe(const PlantSensors& sensors) {
  const auto begin = sensors.joint_fault.begin();
  const auto end = begin + config_.joint_count;
  const auto active = [](const Fault& fault) { return fault.active(); };
  const auto faulty = std::count_if(begin, end, active);
  FaultChange change = FaultChange::kNone;
  if (sensors.fault || faulty == config_.joint_count) {
    guard_.Fail(sensors.fault ? Fault{.cause = FaultCause::kPlant} : *begin);
    change = FaultChange::kRobot;
  } else if (faulty > faulty_joints_) {
    guard_.JointFault(*std::find_if(begin, end, active));
    change = FaultChange::kJoint;
  }
  faulty_joints_ = faulty;
  return change;
}

FaultChange ProviderCycle::ObserveBody(std::uint64_t tick, const PlantSensors& sensors,
                                       const BodySensors& body) {
  if (!fall_ || !fall_->Step(tick, sensors, body, state(), asks_ ? &command_ : nullptr)) {
    return FaultChange::kNone;
  }
  guard_.Fall();
  return FaultChange::kRobot;
}

bool ProviderCycle::AwaitsCommand(std::uint64_t tick) const {
  return types::MayMove(state()) && joint_answers_ < tick + 1;
}

}  // namespace sinew::provider
