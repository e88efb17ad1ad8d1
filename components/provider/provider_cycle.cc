#include "components/provider/provider_cycle.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace sinew::provider {

using types::ControlMode;
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
  guard_.StartSession(config.session_id);
  period_ = std::chrono::nanoseconds(std::llround(1e9 / config.rate_Hz));
  period_s_ = 1.0 / config.rate_Hz;
  if (config.duration_s > 0.0) {
    last_tick_ = static_cast<std::uint64_t>(std::llround(config.duration_s * config.rate_Hz)) - 1;
  }
}

OperatorResult ProviderCycle::Take(const OperatorCommand& command, std::uint64_t tick) {
  switch (command.action) {
    case OperatorAction::kArm:
      if (guard_.Arm(command.session_id, tick)) return OperatorResult::kDone;
      return state() == RobotState::kFault || state() == RobotState::kEstopped
                 ? OperatorResult::kRefusedResetFirst
                 : OperatorResult::kRefusedOtherSession;
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
      faulty_joints_ = 0;
      guard_.Reset();
      return OperatorResult::kClearFaults;
    case OperatorAction::kStart:
    case OperatorAction::kStop:
      break;
  }
  return OperatorResult::kNotForProvider;
}

bool ProviderCycle::Take(const JointCommand& command, std::uint64_t tick) {
  if (command.header.session_id == config_.session_id) joint_answers_ = command.header.tick + 1;
  if (!guard_.Offer(command.header, tick)) return false;
  joints_ = command;
  return true;
}

bool ProviderCycle::Take(const ValveCommand& command, std::uint64_t tick) {
  if (command.header.session_id != config_.session_id) return false;
  valve_answers_ = command.header.tick + 1;
  if (command.header.tick > tick) return false;
  if (config_.guard.live && command.header.origin != Origin::kLive) return false;
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

const PlantCommand& ProviderCycle::Command(std::uint64_t tick, const PlantSensors& sensors) {
  const Verdict verdict = guard_.Step(tick, period_);
  const bool valves_follow = ValvesFollow(tick);
  const auto joints = static_cast<std::size_t>(config_.joint_count);
  for (std::size_t j = 0; j < joints; ++j) {
    command_.motor_torque_Nm[j] = 0.0;
    switch (sensors.joint_fault[j] ? Verdict::kIdle : verdict) {
      case Verdict::kIdle:
        command_.mode[j] = ControlMode::kIdle;
        break;
      case Verdict::kPass:
        Pass(j);
        break;
      case Verdict::kHold:
        if (!holding_) command_.position_rad[j] = sensors.position_rad[j];
        command_.mode[j] = ControlMode::kPosition;
        command_.velocity_rad_s[j] = 0.0;
        break;
      case Verdict::kDamp:
        command_.mode[j] = ControlMode::kTorque;
        command_.motor_torque_Nm[j] =
            -config_.guard.damping_Nm_s_rad * sensors.motor_velocity_rad_s[j];
        break;
    }
    const bool follows = valves_follow && static_cast<int>(j) < valves_->joint_count;
    command_.valve_open[j] = follows && valves_->valve_open[j];
    command_.compressor_on[j] = follows && valves_->compressor_on[j];
    command_.vent_open[j] = follows && valves_->vent_open[j];
  }
  holding_ = verdict == Verdict::kHold;
  return command_;
}

void ProviderCycle::Pass(std::size_t j) {
  command_.mode[j] =
      static_cast<int>(j) < joints_.joint_count ? joints_.mode[j] : ControlMode::kIdle;
  command_.motor_torque_Nm[j] = joints_.motor_torque_Nm[j];
  command_.position_rad[j] = joints_.position_rad[j];
  command_.velocity_rad_s[j] = joints_.velocity_rad_s[j];
  if (std::isfinite(command_.motor_torque_Nm[j]) && std::isfinite(command_.position_rad[j]) &&
      std::isfinite(command_.velocity_rad_s[j])) {
    return;
  }
  guard_.Fault();
  command_.mode[j] = ControlMode::kIdle;
  command_.motor_torque_Nm[j] = 0.0;
}

bool ProviderCycle::ValvesFollow(std::uint64_t tick) const {
  if (!valves_) return false;
  const auto age = static_cast<std::int64_t>(tick - valves_->header.tick);
  return age * period_ <= config_.guard.fault_after;
}

FaultChange ProviderCycle::Observe(const PlantSensors& sensors) {
  const auto begin = sensors.joint_fault.begin();
  const auto faulty = std::count(begin, begin + config_.joint_count, true);
  FaultChange change = FaultChange::kNone;
  if (sensors.fault || faulty == config_.joint_count) {
    guard_.Fault();
    change = FaultChange::kRobot;
  } else if (faulty > faulty_joints_) {
    guard_.JointFault();
    change = FaultChange::kJoint;
  }
  faulty_joints_ = faulty;
  return change;
}

bool ProviderCycle::AwaitsCommand(std::uint64_t tick) const {
  return types::MayMove(state()) && joint_answers_ < tick + 1;
}

}  // namespace sinew::provider
