// Arming as a state machine, on measurements made by hand: no bus, no clock.
#include "bridge/joints/axis_state.h"

#include <gtest/gtest.h>

#include <vector>

#include "components/base/types/angle.h"
#include "components/base/types/control_mode.h"
#include "tests/bridge/joints/one_joint.h"

namespace sinew::bridge {
namespace {

using types::FaultCause;

using types::ControlMode;

constexpr std::int64_t kTimeout_ns = 1'000 * kMs_ns;

class AxisState : public ::testing::Test {
 protected:
  AxisState() : config(Knee()), measured(config), fault(config), axis(kTimeout_ns) {}

  AxisDecision Step(ControlMode command) { return axis.Step(command, measured, now_ns, &fault); }
  void Heartbeat(can::AxisState state, std::uint32_t error = 0) {
    measured.heartbeat.axis_state = state;
    measured.heartbeat.axis_error = error;
    measured.heartbeat_ns = now_ns;
  }
  void Activate(ControlMode mode) {
    (void)Step(mode);
    now_ns += kMs_ns;
    Heartbeat(can::AxisState::kClosedLoopControl);
    (void)Step(mode);
    ASSERT_EQ(axis.phase(), AxisPhase::kActive);
  }

  JointConfig config;
  JointMeasurement measured;
  FaultLatch fault;
  AxisStateMachine axis;
  std::int64_t now_ns = 5'000 * kMs_ns;
};

void ExpectDecision(const AxisDecision& decision, AxisRequest request, bool follows_command,
                    bool restart_setpoint) {
  EXPECT_EQ(decision.request, request);
  EXPECT_EQ(decision.follows_command, follows_command);
  EXPECT_EQ(decision.restart_setpoint, restart_setpoint);
}

TEST_F(AxisState, BeginsIdleAndStaysIdleWithoutACommand) {
  Heartbeat(can::AxisState::kIdle);
  ExpectDecision(Step(ControlMode::kIdle), AxisRequest::kNone, false, false);
  EXPECT_EQ(axis.phase(), AxisPhase::kIdle);
  EXPECT_EQ(axis.mode(), ControlMode::kIdle);
}

TEST_F(AxisState, ACommandArmsAndNothingMovesBeforeTheHeartbeatConfirms) {
  ExpectDecision(Step(ControlMode::kTorque), AxisRequest::kClosedLoop, false, false);
  EXPECT_EQ(axis.phase(), AxisPhase::kArming);
  EXPECT_EQ(axis.mode(), ControlMode::kTorque);
  for (int i = 0; i < 20; ++i) {
    now_ns += 4 * kMs_ns;
    ExpectDecision(Step(ControlMode::kTorque), AxisRequest::kNone, false, false);
  }
  Heartbeat(can::AxisState::kIdle);
  ExpectDecision(Step(ControlMode::kTorque), AxisRequest::kNone, false, false);
  Heartbeat(can::AxisState::kClosedLoopControl);
  ExpectDecision(Step(ControlMode::kTorque), AxisRequest::kNone, true, true);
  EXPECT_EQ(axis.phase(), AxisPhase::kActive);
  ExpectDecision(Step(ControlMode::kTorque), AxisRequest::kNone, true, false);
}

TEST_F(AxisState, AHeartbeatFromBeforeTheRequestConfirmsNothing) {
  Heartbeat(can::AxisState::kClosedLoopControl);
  ExpectDecision(Step(ControlMode::kTorque), AxisRequest::kClosedLoop, false, false);
  now_ns += 4 * kMs_ns;
  ExpectDecision(Step(ControlMode::kTorque), AxisRequest::kNone, false, false);
  EXPECT_EQ(axis.phase(), AxisPhase::kArming);
}

TEST_F(AxisState, ClosedLoopIsRequestedAgainEveryTenthOfASecond) {
  (void)Step(ControlMode::kTorque);
  now_ns += 100 * kMs_ns;
  EXPECT_EQ(Step(ControlMode::kTorque).request, AxisRequest::kNone);
  now_ns += 1;
  EXPECT_EQ(Step(ControlMode::kTorque).request, AxisRequest::kClosedLoop);
  now_ns += 100 * kMs_ns;
  EXPECT_EQ(Step(ControlMode::kTorque).request, AxisRequest::kNone);
  now_ns += 1;
  EXPECT_EQ(Step(ControlMode::kTorque).request, AxisRequest::kClosedLoop);
}

TEST_F(AxisState, AModeThatChangesWhileArmingIsRequestedAtOnce) {
  (void)Step(ControlMode::kTorque);
  now_ns += kMs_ns;
  ExpectDecision(Step(ControlMode::kVelocity), AxisRequest::kClosedLoop, false, false);
  EXPECT_EQ(axis.mode(), ControlMode::kVelocity);
  now_ns += kMs_ns;
  Heartbeat(can::AxisState::kClosedLoopControl);
  ExpectDecision(Step(ControlMode::kPosition), AxisRequest::kClosedLoop, true, true);
  EXPECT_EQ(axis.mode(), ControlMode::kPosition);
}

TEST_F(AxisState, TheModeIsSentAgainEveryTenthOfASecondWhileActive) {
  std::vector<std::int64_t> first_ns;  // after the command began to count
  for (const int node : {1, 2, 63}) {
    config.node = node;
    axis = AxisStateMachine(kTimeout_ns);
    Activate(ControlMode::kTorque);
    const std::int64_t begin_ns = now_ns;
    std::vector<std::int64_t> sent_ns;
    while (now_ns < begin_ns + 1000 * kMs_ns) {
      now_ns += kMs_ns;
      const AxisDecision decision = Step(ControlMode::kTorque);
      EXPECT_TRUE(decision.follows_command);
      if (decision.request == AxisRequest::kModeAgain) sent_ns.push_back(now_ns - begin_ns);
    }
    ASSERT_GE(sent_ns.size(), 8U);
    for (std::size_t k = 1; k < sent_ns.size(); ++k) {
      EXPECT_EQ(sent_ns[k] - sent_ns[k - 1], 101 * kMs_ns);
    }
    EXPECT_LE(sent_ns[0], 100 * kMs_ns);
    first_ns.push_back(sent_ns[0]);
  }
  EXPECT_LT(first_ns[0], first_ns[1]) << "axes take turns";
  EXPECT_LT(first_ns[1], first_ns[2]);
}

TEST_F(AxisState, NoClosedLoopWithinTheTimeLimitIsAFault) {
  (void)Step(ControlMode::kTorque);
  now_ns += kTimeout_ns;
  (void)Step(ControlMode::kTorque);
  EXPECT_FALSE(fault.active());
  now_ns += 1;
  ExpectDecision(Step(ControlMode::kTorque), AxisRequest::kNone, false, false);
  EXPECT_EQ(fault.cause(), FaultCause::kNoClosedLoop);
  ExpectDecision(Step(ControlMode::kTorque), AxisRequest::kIdle, false, false);
  EXPECT_EQ(axis.phase(), AxisPhase::kIdle);
}

TEST_F(AxisState, AnActiveAxisThatLeavesClosedLoopWithoutAnErrorIsAFault) {
  Activate(ControlMode::kTorque);
  now_ns += kMs_ns;
  Heartbeat(can::AxisState::kIdle, can::axis_error::kMotorFailed);
  EXPECT_TRUE(Step(ControlMode::kTorque).follows_command);
  EXPECT_FALSE(fault.active()) << "the error is a fault of its own, of the fault rules";
  Heartbeat(can::AxisState::kIdle);
  ExpectDecision(Step(ControlMode::kTorque), AxisRequest::kNone, false, false);
  EXPECT_EQ(fault.cause(), FaultCause::kNoClosedLoop);
}

TEST_F(AxisState, AModeThatChangesInClosedLoopRestartsTheSetpoint) {
  Activate(ControlMode::kTorque);
  ExpectDecision(Step(ControlMode::kPosition), AxisRequest::kMode, true, true);
  EXPECT_EQ(axis.mode(), ControlMode::kPosition);
  ExpectDecision(Step(ControlMode::kPosition), AxisRequest::kNone, true, false);
}

TEST_F(AxisState, IdleCommandAndFaultEndTheMotionAtOnce) {
  Activate(ControlMode::kTorque);
  ExpectDecision(Step(ControlMode::kIdle), AxisRequest::kIdle, false, false);
  EXPECT_EQ(axis.phase(), AxisPhase::kIdle);
  Activate(ControlMode::kTorque);
  fault.Fail(FaultCause::kEstimatesLost, "why");
  ExpectDecision(Step(ControlMode::kTorque), AxisRequest::kIdle, false, false);
  EXPECT_EQ(axis.phase(), AxisPhase::kIdle);
  ExpectDecision(Step(ControlMode::kTorque), AxisRequest::kIdle, false, false);
  now_ns += kMs_ns;
  Heartbeat(can::AxisState::kIdle);
  ExpectDecision(Step(ControlMode::kTorque), AxisRequest::kNone, false, false);
}

TEST_F(AxisState, IdleIsRequestedInEveryCycleUntilANewerHeartbeatReportsIt) {
  Activate(ControlMode::kTorque);
  (void)Step(ControlMode::kIdle);
  for (int k = 0; k < 30; ++k) {
    now_ns += 4 * kMs_ns;
    if (k == 10) Heartbeat(can::AxisState::kClosedLoopControl);
    EXPECT_EQ(Step(ControlMode::kIdle).request, AxisRequest::kIdle) << k;
  }
  Heartbeat(can::AxisState::kIdle);
  EXPECT_EQ(Step(ControlMode::kIdle).request, AxisRequest::kNone) << "it is idle now";
  Heartbeat(can::AxisState::kClosedLoopControl);
  EXPECT_EQ(Step(ControlMode::kIdle).request, AxisRequest::kIdle) << "and is not any more";
}

TEST_F(AxisState, GoIdleFromAnyPhaseNeedsArmingToMoveAgain) {
  Activate(ControlMode::kTorque);
  axis.GoIdle(now_ns);
  EXPECT_EQ(axis.phase(), AxisPhase::kIdle);
  ExpectDecision(Step(ControlMode::kTorque), AxisRequest::kClosedLoop, false, false);
}

TEST_F(AxisState, AJointWhoseZeroCheckFailsIsNotArmed) {
  config.zero_check = ZeroCheck{0.04, 0.005};
  measured.output.angle_rad = 0.026;
  ExpectDecision(Step(ControlMode::kTorque), AxisRequest::kNone, false, false);
  EXPECT_EQ(fault.cause(), FaultCause::kZero);
  EXPECT_EQ(axis.phase(), AxisPhase::kIdle);
}

// --- errors

TEST_F(AxisState, AnExpiredWatchdogOfAnAxisThatIsNotActiveIsCleared) {
  Heartbeat(can::AxisState::kIdle, can::axis_error::kWatchdogTimerExpired);
  EXPECT_EQ(axis.AssessErrors(now_ns, fault, &measured), ErrorAction::kClear);
  EXPECT_EQ(measured.heartbeat.axis_error, 0U);
  EXPECT_EQ(measured.errors_cleared_ns, now_ns + kClearing_ns);
  EXPECT_EQ(axis.AssessErrors(now_ns, fault, &measured), ErrorAction::kNone);
  (void)Step(ControlMode::kTorque);
  Heartbeat(can::AxisState::kIdle, can::axis_error::kWatchdogTimerExpired);
  EXPECT_EQ(axis.AssessErrors(now_ns, fault, &measured), ErrorAction::kClear) << "while arming";
}

TEST_F(AxisState, AnExpiredWatchdogStaysWithAnActiveAxisWithAFaultAndWithOtherErrors) {
  Heartbeat(can::AxisState::kIdle,
            can::axis_error::kWatchdogTimerExpired | can::axis_error::kMotorFailed);
  EXPECT_EQ(axis.AssessErrors(now_ns, fault, &measured), ErrorAction::kRequestCodes);
  EXPECT_NE(measured.heartbeat.axis_error, 0U);
  measured.heartbeat.axis_error = 0;
  axis.ForgetErrors();
  Activate(ControlMode::kTorque);
  Heartbeat(can::AxisState::kIdle, can::axis_error::kWatchdogTimerExpired);
  EXPECT_EQ(axis.AssessErrors(now_ns, fault, &measured), ErrorAction::kRequestCodes);
  axis.GoIdle(now_ns);
  axis.ForgetErrors();
  fault.Fail(FaultCause::kAxisError, "why");
  EXPECT_EQ(axis.AssessErrors(now_ns, fault, &measured), ErrorAction::kRequestCodes);
}

TEST_F(AxisState, ErrorCodesAreRequestedOnceUntilTheReset) {
  Heartbeat(can::AxisState::kIdle, can::axis_error::kMotorFailed);
  EXPECT_EQ(axis.AssessErrors(now_ns, fault, &measured), ErrorAction::kRequestCodes);
  EXPECT_EQ(axis.AssessErrors(now_ns, fault, &measured), ErrorAction::kNone);
  axis.ForgetErrors();
  EXPECT_EQ(axis.AssessErrors(now_ns, fault, &measured), ErrorAction::kRequestCodes);
}

// --- homing and zero check

TEST(Homing, FindsTheWholeTurnsWithinHalfATurnInBothDirections) {
  for (const int direction : {1, -1}) {
    for (const double turns : {-23.0, -1.0, 0.0, 1.0, 7.0}) {
      for (const double rest : {-0.49, 0.0, 0.49}) {
        JointConfig config = Knee();
        config.direction = direction;
        config.zero_rev = 0.25;
        JointMeasurement measured(config);
        const double output_rad = 0.3;
        measured.output.angle_rad = output_rad;
        measured.estimates.position_rev =
            direction * 100.0 * output_rad / types::kTwoPi + config.zero_rev + turns + rest;
        EXPECT_EQ(WholeTurnsOff(measured), turns) << direction << " " << rest;
        measured.home_rev = 99.0;
        EXPECT_EQ(WholeTurnsOff(measured), turns) << "whatever was found before";
      }
    }
  }
}

TEST(ZeroCheck, HoldsUpToHalfThePlayAndTheTolerance) {
  JointConfig config = Knee();
  JointMeasurement measured(config);
  measured.output.angle_rad = 1.0;
  const auto failure = [&] {
    FaultLatch fault(config);
    AssessZero(measured, &fault);
    return fault;
  };
  EXPECT_FALSE(failure().active()) << "no check is configured";
  config.zero_check = ZeroCheck{0.04, 0.005};
  for (const double sign : {1.0, -1.0}) {
    measured.output.angle_rad = sign * 0.0249;
    EXPECT_FALSE(failure().active());
    measured.output.angle_rad = sign * 0.0251;
    EXPECT_EQ(failure().cause(), FaultCause::kZero);
  }
  EXPECT_EQ(
      failure().text(),
      "joint 'knee' (node 3): zero check: 0.025 rad, limit 0.025 rad, the output is at 0.0000 "
      "rad by the motor and at -0.0251 rad by its own encoder: check the zero of both encoders");
}

}  // namespace
}  // namespace sinew::bridge
