#include "bridge/joints/axis_state.h"

#include <cmath>
#include <cstdio>

#include "components/base/types/angle.h"

namespace sinew::bridge {
namespace {

using types::ControlMode;
using types::FaultCause;

constexpr std::int64_t kRequestAgain_ns = 100'000'000;

}  // namespace

AxisDecision AxisStateMachine::Step(ControlMode command, const JointMeasurement& measured,
                                    std::int64_t now_ns, FaultLatch* fault) {
  const bool closed_loop = measured.closed_loop();
  const bool heartbeat_since = measured.heartbeat_ns > phase_ns_;
  if (command == ControlMode::kIdle || fault->active()) {
    if (phase_ != AxisPhase::kIdle) {
      GoIdle(now_ns);
      return {.request = AxisRequest::kIdle};
    }
    const bool confirmed = heartbeat_since && !closed_loop;
    return {.request = confirmed ? AxisRequest::kNone : AxisRequest::kIdle};
  }
  switch (phase_) {
    case AxisPhase::kIdle:
      AssessZero(measured, fault);
      if (fault->active()) return {};
      Enter(AxisPhase::kArming, now_ns);
      mode_ = command;
      return {.request = Request(AxisRequest::kClosedLoop, now_ns)};
    case AxisPhase::kArming:
      return StepArming(command, closed_loop && heartbeat_since,
                        kRequestAgain_ns * measured.config->node / (can::kMaxNode + 1), now_ns,
                        fault);
    case AxisPhase::kActive:
      break;
  }
  AxisDecision decision;
  if (mode_ != command) {
    mode_ = command;
    decision.request = Request(AxisRequest::kMode, now_ns);
    decision.restart_setpoint = true;
  } else if (RequestIsOld(now_ns)) {
    decision.request = Request(AxisRequest::kModeAgain, now_ns);
  }
  if (heartbeat_since && !closed_loop && measured.heartbeat.axis_error == 0) {
    fault->Fail(FaultCause::kNoClosedLoop, "the axis left it");
  }
  decision.follows_command = !fault->active();
  return decision;
}

AxisDecision AxisStateMachine::StepArming(ControlMode command, bool confirmed, std::int64_t turn_ns,
                                          std::int64_t now_ns, FaultLatch* fault) {
  AxisDecision decision;
  if (mode_ != command) {
    mode_ = command;
    decision.request = Request(AxisRequest::kClosedLoop, now_ns);
  }
  if (confirmed) {
    Enter(AxisPhase::kActive, now_ns);
    // Axes that were armed together take turns.
    requested_ns_ = now_ns - kRequestAgain_ns + turn_ns;
    decision.restart_setpoint = true;
    decision.follows_command = true;
  } else if (now_ns - phase_ns_ > closed_loop_timeout_ns_) {
    fault->Fail({.cause = FaultCause::kNoClosedLoop,
                 .value = 1e-6 * static_cast<double>(now_ns - phase_ns_),
                 .limit = 1e-6 * static_cast<double>(closed_loop_timeout_ns_)},
                "the axis does not enter it");
  } else if (RequestIsOld(now_ns)) {
    decision.request = Request(AxisRequest::kClosedLoop, now_ns);
  }
  return decision;
}

void AxisStateMachine::GoIdle(std::int64_t now_ns) { Enter(AxisPhase::kIdle, now_ns); }

ErrorAction AxisStateMachine::AssessErrors(std::int64_t now_ns, const FaultLatch& fault,
                                           JointMeasurement* measured) {
  if (phase_ != AxisPhase::kActive && !fault.active() &&
      measured->heartbeat.axis_error == can::axis_error::kWatchdogTimerExpired) {
    measured->ClearErrors(now_ns + kClearing_ns);
    return ErrorAction::kClear;
  }
  if (measured->heartbeat.axis_error == 0 || codes_requested_) return ErrorAction::kNone;
  codes_requested_ = true;
  return ErrorAction::kRequestCodes;
}

void AxisStateMachine::Enter(AxisPhase phase, std::int64_t now_ns) {
  phase_ = phase;
  phase_ns_ = now_ns;
}

bool AxisStateMachine::RequestIsOld(std::int64_t now_ns) const {
  return now_ns - requested_ns_ > kRequestAgain_ns;
}

AxisRequest AxisStateMachine::Request(AxisRequest request, std::int64_t now_ns) {
  requested_ns_ = now_ns;
  return request;
}

double WholeTurnsOff(const JointMeasurement& measured) {
  const JointConfig& c = *measured.config;
  const double motor_rad =
      c.direction * types::kTwoPi * (measured.estimates.position_rev - c.zero_rev);
  const double off_rad = motor_rad - c.gear_ratio * measured.position_rad();
  return c.direction * std::round(off_rad / types::kTwoPi);
}

void AssessZero(const JointMeasurement& measured, FaultLatch* fault) {
  const auto& check = measured.config->zero_check;
  if (!check) return;
  const double motor_rad = measured.motor_position_at_output_rad();
  const double output_rad = measured.position_rad();
  const double apart_rad = std::abs(motor_rad - output_rad);
  if (apart_rad <= check->largest_rad()) return;
  char text[96];
  std::snprintf(text, sizeof text,
                "the output is at %.4f rad by the motor and at %.4f rad by its own encoder",
                motor_rad, output_rad);
  fault->Fail({.cause = FaultCause::kZero, .value = apart_rad, .limit = check->largest_rad()},
              text);
}

}  // namespace sinew::bridge
