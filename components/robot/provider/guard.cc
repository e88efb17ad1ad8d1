#include "components/robot/provider/guard.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "components/base/types/command_rule.h"

namespace sinew::provider {

using types::Fault;
using types::FaultCause;
using types::Origin;
using types::RobotState;

namespace {

Verdict VerdictOf(OtherJointsPolicy policy) {
  switch (policy) {
    case OtherJointsPolicy::kDamp:
      return Verdict::kDamp;
    case OtherJointsPolicy::kHold:
      return Verdict::kHold;
    case OtherJointsPolicy::kIdle:
    case OtherJointsPolicy::kContinue:
      break;
  }
  return Verdict::kIdle;
}

}  // namespace

CommandGuard::CommandGuard(const GuardConfig& config) : config_(config) {
  if (config.missed_periods < 1) {
    throw std::invalid_argument("missed_periods must be at least 1, is " +
                                std::to_string(config.missed_periods));
  }
  if (config.fault_after.count() <= 0) {
    throw std::invalid_argument("fault_after must be positive, is " +
                                std::to_string(config.fault_after.count()) + " ms");
  }
  if (!std::isfinite(config.damping_Nm_s_rad) || config.damping_Nm_s_rad < 0.0) {
    throw std::invalid_argument("damping must not be negative");
  }
}

void CommandGuard::StartSession(std::uint64_t session_id) {
  session_id_ = session_id;
  state_ = RobotState::kDisarmed;
  fault_ = {};
  has_command_ = false;
}

bool CommandGuard::Arm(std::uint64_t session_id, std::uint64_t tick) {
  if (session_id != session_id_) return false;
  if (state_ == RobotState::kFault || state_ == RobotState::kEstopped) return false;
  if (state_ == RobotState::kDisarmed) {
    last_tick_ = tick;
    has_command_ = false;
    state_ = RobotState::kArmed;
  }
  return true;
}

void CommandGuard::Disarm() {
  in_fault_ = Verdict::kIdle;
  if (types::MayMove(state_)) state_ = RobotState::kDisarmed;
}

void CommandGuard::Estop() {
  in_fault_ = Verdict::kIdle;
  state_ = RobotState::kEstopped;
}

void CommandGuard::JointFault(const Fault& fault) {
  if (config_.on_joint_fault == OtherJointsPolicy::kContinue) return;
  const bool moved = in_fault_ != Verdict::kIdle || types::MayMove(state_);
  Fail(fault);
  if (moved) in_fault_ = VerdictOf(config_.on_joint_fault);
}

void CommandGuard::Fall() {
  const bool moved = in_fault_ != Verdict::kIdle || types::MayMove(state_);
  Fail({.cause = FaultCause::kFall});
  if (moved && config_.on_fall == FallPolicy::kDamp) in_fault_ = Verdict::kDamp;
}

void CommandGuard::Fail(const Fault& fault) {
  in_fault_ = Verdict::kIdle;
  if (state_ == RobotState::kEstopped || state_ == RobotState::kFault) return;
  state_ = RobotState::kFault;
  fault_ = fault;
  ++faults_;
}

bool CommandGuard::Reset() {
  in_fault_ = Verdict::kIdle;
  if (state_ != RobotState::kFault && state_ != RobotState::kEstopped) return false;
  state_ = RobotState::kDisarmed;
  fault_ = {};
  return true;
}

bool CommandGuard::Offer(const types::MessageHeader& header, std::uint64_t tick) {
  const types::RunningSession running{session_id_, config_.live ? Origin::kLive : Origin::kSim};
  const bool counts = types::RefusalOf(types::CommandKind::kRequest, header, running) ==
                          types::CommandRefusal::kNone &&
                      header.tick <= tick && (!has_command_ || header.tick > last_tick_);
  if (!counts) {
    ++refused_;
    return false;
  }
  if (types::MayMove(state_)) {
    if (header.tick < last_tick_) return false;  // computed before arming
    last_tick_ = header.tick;
    has_command_ = true;
  }
  return true;
}

bool CommandGuard::Overdue(std::uint64_t tick) const {
  return tick - last_tick_ > static_cast<std::uint64_t>(config_.missed_periods);
}

Verdict CommandGuard::Step(std::uint64_t tick, std::chrono::nanoseconds period,
                           std::chrono::nanoseconds age) {
  if (in_fault_ != Verdict::kIdle) return in_fault_;
  if (!types::MayMove(state_)) return Verdict::kIdle;
  const std::chrono::nanoseconds old =
      std::max(static_cast<std::int64_t>(tick - last_tick_) * period, age - period);
  if (old > config_.fault_after) {
    Fail({.cause = FaultCause::kCommandMissing,
          .value = Milliseconds(old),
          .limit = Milliseconds(config_.fault_after)});
    return Verdict::kIdle;
  }
  if (old >= config_.missed_periods * period) {
    state_ = RobotState::kDamped;
    return config_.bridging == Bridging::kHold ? Verdict::kHold : Verdict::kDamp;
  }
  state_ = RobotState::kArmed;
  if (!has_command_) return Verdict::kIdle;
  return Verdict::kPass;
}

}  // namespace sinew::provider
