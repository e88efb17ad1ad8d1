// Behaviour of the joint and robot controllers: take-over, limits, safe commands, motion orders,
// and closed loops on a small rig written for these tests.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "components/base/types/control_mode.h"
#include "components/base/types/regime.h"
#include "components/robot/control/robot_controller.h"
#include "components/robot/reference/generator.h"
#include "tests/components/robot/control/terms.h"
#include "tests/components/robot/control/test_plant.h"
#include "tests/support/allocations.h"
#include "tests/support/rig_constants.h"

namespace sinew::control {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// The model of TestRig as close-loop would know it.
actuator::JointModel ModelOf(const TestRig& rig) {
  actuator::JointModel model;
  model.constants = {
      .gear_ratio = rig.gear_ratio, .link_length_m = 0.3, .torque_constant_Nm_A = 0.0159155};
  AddTerm(&model, "drive_current", {rig.efficiency});
  AddTerm(&model, "rotor_inertia", {rig.rotor_inertia_kg_m2});
  AddTerm(&model, "link_inertia", {rig.link_inertia_kg_m2});
  AddTerm(&model, "motor_viscous", {rig.viscous_Nm_s_rad});
  AddTerm(&model, "coulomb", {rig.coulomb_Nm});
  AddTerm(&model, "gravity", {rig.gravity_Nm});
  AddTerm(&model, "pneumatic_torque", {rig.pneumatic_Nm / 4.0});
  return model;
}

JointControlConfig RigConfig(Strategy strategy) {
  const TestRig rig;
  JointControlConfig config;
  config.strategy = strategy;
  config.pid = {.proportional_Nm_rad = 12.0,
                .integral_Nm_rad_s = 10.0,
                .derivative_Nm_s_rad = 1.0,
                .derivative_filter_Hz = 40.0,
                .anti_windup_s = 0.2};
  config.gear_ratio = rig.gear_ratio;
  config.shaft_per_output = 1.0 / (rig.gear_ratio * rig.efficiency);
  config.motor_torque_limit_Nm = 0.398;
  config.model = ModelOf(rig);
  config.compensator.kind = CompensatorKind::kModel;
  return config;
}

RobotInput InputOf(const TestRig& rig) {
  RobotInput input;
  input.session_id = 7;
  input.period_s = kCycle_s;
  input.armed = true;
  input.joint_count = 1;
  MeasuredJointState& m = input.joint[0];
  m.valid = m.actuator_valid = true;
  m.position_rad = rig.encoder_rad();
  m.velocity_rad_s = rig.link_rad_s;
  m.motor_position_rad = rig.gear_ratio * rig.motor_rad;
  m.motor_velocity_rad_s = rig.gear_ratio * rig.motor_rad_s;
  m.pressure_bar = 4.0;
  input.reference_fresh = true;
  return input;
}

RobotInput Still(double position_rad) {
  TestRig rig;
  rig.link_rad = rig.motor_rad = position_rad;
  RobotInput input = InputOf(rig);
  input.joint[0].position_rad = position_rad;
  return input;
}

TEST(RobotController, IsIdleUntilArmed) {
  RobotController controller({RigConfig(Strategy::kPid)});
  RobotInput input = Still(0.4);
  input.armed = false;
  input.reference_count = 1;
  input.reference[0] = {1.0, 0.0, 0.0};
  for (int k = 0; k < 100; ++k) {
    const RobotOutput out = controller.Step(input);
    EXPECT_EQ(out.joint[0].mode, types::ControlMode::kIdle);
    EXPECT_EQ(out.joint[0].motor_torque_Nm, 0.0);
    EXPECT_FALSE(out.stale);
  }
}

TEST(RobotController, ArmedWithoutReferenceHoldsWhereTheJointStands) {
  RobotController controller({RigConfig(Strategy::kPid)});
  for (int k = 0; k < 100; ++k) {
    const RobotOutput out = controller.Step(Still(0.4));
    EXPECT_EQ(out.joint[0].mode, types::ControlMode::kTorque);
    EXPECT_EQ(out.joint[0].motor_torque_Nm, 0.0);  // zero case: no error, no torque
    EXPECT_EQ(out.joint[0].position_rad, 0.4);
    EXPECT_FALSE(out.stale);
  }
  // Moved away from there it pushes back with the proportional term at the motor shaft.
  const JointControlConfig config = RigConfig(Strategy::kPid);
  const RobotOutput out = controller.Step(Still(0.5));
  EXPECT_NEAR(out.joint[0].motor_torque_Nm,
              -0.1 * (12.0 + 10.0 * kCycle_s) * config.shaft_per_output, 1e-12);
}

TEST(RobotController, TakesOverWithoutAJumpEvenWhenTheReferenceIsElsewhere) {
  for (const Strategy strategy : {Strategy::kPosition, Strategy::kPid, Strategy::kPidLinear}) {
    RobotController controller({RigConfig(strategy)});
    RobotInput input = Still(0.4);
    input.reference_count = 1;
    input.reference[0] = {0.9, 0.0, 0.0};
    double before_rad = 0.4;
    for (int k = 0; k < 240; ++k) {
      const RobotOutput out = controller.Step(input);
      const double position_rad = out.joint[0].position_rad;
      // Peak speed of the quintic: 1.875 way / time.
      EXPECT_LE(std::abs(position_rad - before_rad), 1.001 * 1.875 * 0.5 / 0.3 * kCycle_s) << k;
      before_rad = position_rad;
      if (k == 0) {
        EXPECT_NEAR(position_rad, 0.4, 1e-12);
      }
    }
    EXPECT_NEAR(before_rad, 0.9, 1e-12);
  }
}

TEST(RobotController, FeedForwardFadesInAndOut) {
  RobotController controller({RigConfig(Strategy::kPidLinear)});
  double before_Nm = 0.0;
  for (int k = 0; k < 240; ++k) {
    const double torque_Nm = controller.Step(Still(0.0)).joint[0].motor_torque_Nm;
    // Balance at rest: -(K P - Tg) / (N efficiency); a first-order fade of 20 ms moves 19 % of it a
    // tick.
    EXPECT_LE(std::abs(torque_Nm - before_Nm), 0.2 * (0.3587 * 4.0 - 0.58) / 77.0) << k;
    before_Nm = torque_Nm;
  }
  EXPECT_NEAR(before_Nm, -(0.3587 * 4.0 - 0.58) / 77.0, 1e-9);
}

TEST(RobotController, NeverPassesTheTorqueLimitAndSaysSo) {
  RobotController controller({RigConfig(Strategy::kPid)});
  static_cast<void>(controller.Step(Still(0.0)));
  for (const double q : {-3.0, 3.0}) {
    const RobotOutput out = controller.Step(Still(q));
    EXPECT_EQ(out.joint[0].motor_torque_Nm, q < 0 ? 0.398 : -0.398);
    EXPECT_TRUE(out.joint[0].saturated);
  }
}

TEST(RobotController, NetworkIsChosenByRegimeAndAnUnknownRegimeLeavesItOut) {
  const JointControlConfig config = RigConfig(Strategy::kPidEsn);
  RobotController controller({config});
  RobotInput input = Still(0.0);
  input.reference_count = 1;
  input.prediction_fresh = input.regime_fresh = true;
  input.prediction[0] = {true, 1.0, -2.0, 0.0};
  const auto settle = [&](types::Regime regime) {
    input.regime[0] = regime;
    double torque_Nm = 0.0, largest_step_Nm = 0.0;
    double before_Nm = controller.Step(input).joint[0].motor_torque_Nm;
    for (int k = 0; k < 240; ++k) {
      torque_Nm = controller.Step(input).joint[0].motor_torque_Nm;
      largest_step_Nm = std::max(largest_step_Nm, std::abs(torque_Nm - before_Nm));
      before_Nm = torque_Nm;
    }
    EXPECT_LE(largest_step_Nm, 0.2 * 3.0 * config.shaft_per_output) << "the change fades";
    return torque_Nm;
  };
  EXPECT_NEAR(settle(types::Regime::kUnknown), 0.0, 1e-12);
  EXPECT_NEAR(settle(types::Regime::kSea), 1.0 * config.shaft_per_output, 1e-7);
  EXPECT_NEAR(settle(types::Regime::kPea), -2.0 * config.shaft_per_output, 1e-7);
  input.regime_fresh = false;
  EXPECT_NEAR(settle(types::Regime::kPea), 0.0, 1e-6);
  EXPECT_TRUE(controller.Step(input).stale);
  input.regime_fresh = true;
  input.prediction[0].valid = false;
  EXPECT_NEAR(settle(types::Regime::kPea), 0.0, 1e-6);
}

TEST(RobotController, AFeedForwardThatBeginsTakesTheIntegralsPlace) {
  JointControlConfig config = RigConfig(Strategy::kPidEsn);
  config.pid.integral_Nm_rad_s = 10.0;
  RobotController controller({config});
  RobotInput input = Still(0.0);
  input.reference_count = 1;
  input.reference[0].position_rad = 0.1;  // held off its reference: the integral fills
  double before_Nm = 0.0;
  for (int k = 0; k < 480; ++k) before_Nm = controller.Step(input).joint[0].motor_torque_Nm;
  const double proportional_Nm = 0.1 * config.pid.proportional_Nm_rad * config.shaft_per_output;
  ASSERT_GT(before_Nm, proportional_Nm + 0.5 * config.shaft_per_output);
  // The network gives what the integral had: the command goes on, and the integral is empty.
  input.prediction_fresh = input.regime_fresh = true;
  input.regime[0] = types::Regime::kPea;
  const double held_Nm = before_Nm - proportional_Nm;
  input.prediction[0] = {true, 0.0, 2.0 * held_Nm / config.shaft_per_output, 0.0};
  const JointOutput first = controller.Step(input).joint[0];
  // One tick of integration and a fifth of the fade.
  EXPECT_NEAR(first.motor_torque_Nm, before_Nm, 0.25 * held_Nm);
  input.reference[0].position_rad = 0.0;  // no error: the integral stays as it is
  JointOutput last;
  for (int k = 0; k < 240; ++k) last = controller.Step(input).joint[0];
  EXPECT_NEAR(last.motor_torque_Nm, 2.0 * held_Nm, 0.05 * held_Nm);
}

TEST(RobotController, WithoutPlayThePredictionsOwnChoiceIsUsed) {
  JointControlConfig config = RigConfig(Strategy::kPidEsn);
  config.by_regime = false;
  config.crossfade_s = 0.0;
  RobotController controller({config});
  RobotInput input = Still(0.0);
  input.reference_count = 1;
  input.prediction_fresh = true;
  input.prediction[0] = {true, 1.0, -2.0, 0.5};
  const RobotOutput out = controller.Step(input);
  EXPECT_NEAR(out.joint[0].motor_torque_Nm, 0.5 * config.shaft_per_output, 1e-12);
  EXPECT_FALSE(out.stale) << "no regime is needed";
}

TEST(RobotController, ANetworkThatGivesNoNumberIsLeftOutAndReported) {
  RobotController controller({RigConfig(Strategy::kPidEsn)});
  RobotInput input = Still(0.0);
  input.reference_count = 1;
  input.prediction_fresh = input.regime_fresh = true;
  input.regime[0] = types::Regime::kPea;
  input.prediction[0] = {true, 0.0, kNaN, 0.0};
  const RobotOutput out = controller.Step(input);
  EXPECT_EQ(out.fault, Fault::kNonFinitePrediction);
  EXPECT_TRUE(out.stale);
  EXPECT_EQ(out.joint[0].mode, types::ControlMode::kTorque);
  EXPECT_EQ(out.joint[0].motor_torque_Nm, 0.0);
  input.prediction[0] = {true, 0.0, 0.0, 0.0};
  EXPECT_EQ(controller.Step(input).fault, Fault::kNone) << "not latched";
}

TEST(RobotController, NonFiniteStateOrReferenceLatchesAFaultUntilDisarmed) {
  const auto check = [](const RobotInput& bad, Fault fault) {
    RobotController controller({RigConfig(Strategy::kPid)});
    static_cast<void>(controller.Step(Still(0.1)));
    RobotOutput out = controller.Step(bad);
    EXPECT_EQ(out.fault, fault);
    EXPECT_TRUE(out.stale);
    EXPECT_EQ(out.joint[0].mode, types::ControlMode::kIdle);
    EXPECT_EQ(out.joint[0].motor_torque_Nm, 0.0);
    out = controller.Step(Still(0.1));
    EXPECT_EQ(out.fault, fault) << "latched";
    EXPECT_EQ(out.joint[0].mode, types::ControlMode::kIdle);
    RobotInput disarmed = Still(0.1);
    disarmed.armed = false;
    EXPECT_EQ(controller.Step(disarmed).fault, Fault::kNone);
    EXPECT_EQ(controller.Step(Still(0.1)).joint[0].mode, types::ControlMode::kTorque);
  };
  RobotInput bad = Still(kNaN);
  check(bad, Fault::kNonFiniteState);
  bad = Still(0.1);
  bad.joint[0].velocity_rad_s = HUGE_VAL;
  check(bad, Fault::kNonFiniteState);
  bad = Still(0.1);
  bad.reference_count = 1;
  bad.reference[0].acceleration_rad_s2 = kNaN;
  check(bad, Fault::kNonFiniteReference);
  bad = Still(0.1);
  bad.period_s = 0.0;
  check(bad, Fault::kNonFiniteState);
}

TEST(RobotController, AFaultOfOneJointSwitchesAllOff) {
  RobotController controller({RigConfig(Strategy::kPid), RigConfig(Strategy::kPid)});
  RobotInput input = Still(0.0);
  input.joint_count = 2;
  input.joint[1] = input.joint[0];
  static_cast<void>(controller.Step(input));
  input.joint[1].position_rad = kNaN;
  const RobotOutput out = controller.Step(input);
  EXPECT_EQ(out.fault_joint, 1);
  EXPECT_EQ(out.joint[0].mode, types::ControlMode::kIdle);
  EXPECT_EQ(out.joint[1].mode, types::ControlMode::kIdle);
}

TEST(RobotController, TooLargeATrackingErrorIsAFault) {
  JointControlConfig config = RigConfig(Strategy::kPid);
  config.tracking_error_limit_rad = 0.5;
  RobotController controller({config});
  RobotInput input = Still(0.0);
  input.reference_count = 1;
  EXPECT_EQ(controller.Step(input).fault, Fault::kNone);
  input.joint[0].position_rad = -0.6;
  EXPECT_EQ(controller.Step(input).fault, Fault::kTrackingError);
}

// A recording that takes over, from a hold or from another reference: no step, over its own time.
TEST(RobotController, ARecordingIsBlendedInOverItsOwnTime) {
  JointControlConfig config = RigConfig(Strategy::kPosition);
  config.takeover_s = 0.3;
  config.replay_takeover_s = 2.0;
  RobotController controller({config});
  RobotInput input = Still(0.2);
  (void)controller.Step(input);
  input.reference_count = 1;
  input.reference[0] = {0.2, 0.0, 0.0};
  for (int k = 0; k < 200; ++k) (void)controller.Step(input);  // another reference, where it is
  input.reference_replayed = true;
  input.reference[0] = {1.2, 0.0, 0.0};
  double last_rad = 0.2;
  double reached_s = 0.0;
  for (int k = 0; k < 1000; ++k) {
    const double now_rad = controller.Step(input).joint[0].position_rad;
    // A quintic's largest velocity is 15/8 of the mean: 1 rad in 2 s.
    ASSERT_LE(std::abs(now_rad - last_rad), 15.0 / 8.0 / 2.0 * input.period_s * 1.001);
    if (now_rad < 1.2 - 1e-9) reached_s += input.period_s;
    last_rad = now_rad;
  }
  EXPECT_NEAR(last_rad, 1.2, 1e-9);
  EXPECT_NEAR(reached_s, 2.0, 0.05);
}

// Of an input that is late: what a standby needs to take over, in whole cycles.
const int kGraceTicks = static_cast<int>(JointControlConfig{}.stale_grace_s / kCycle_s);

TEST(RobotController, ALateReferenceGoesOnAndALostOneStaysOrIsDamped) {
  for (const OnStale on_stale : {OnStale::kHold, OnStale::kDamp}) {
    JointControlConfig config = RigConfig(Strategy::kPid);
    config.on_stale = on_stale;
    RobotController controller({config});
    RobotInput input = Still(0.2);
    input.reference_count = 1;
    for (int k = 0; k < 100; ++k) {
      input.reference[0] = {0.2 + 0.001 * k, 0.24, 0.0};
      EXPECT_FALSE(controller.Step(input).stale);
    }
    input.reference_fresh = false;
    const double end_rad = 0.299 + 0.001 * kGraceTicks;
    for (int k = 1; k < 20; ++k) {
      input.reference[0] = {99.0, 99.0, 99.0};  // must not be read
      const RobotOutput out = controller.Step(input);
      EXPECT_TRUE(out.stale);
      EXPECT_EQ(out.joint[0].mode, types::ControlMode::kTorque);
      if (k <= kGraceTicks) {
        EXPECT_NEAR(out.joint[0].position_rad, 0.299 + 0.001 * k, 1e-12);
        EXPECT_NEAR(out.joint[0].velocity_rad_s, 0.24, 1e-12);
      } else if (on_stale == OnStale::kHold) {
        EXPECT_NEAR(out.joint[0].position_rad, end_rad, 1e-12);
        EXPECT_EQ(out.joint[0].velocity_rad_s, 0.0);
        EXPECT_GT(out.joint[0].motor_torque_Nm, 0.0);
      } else {
        EXPECT_EQ(out.joint[0].motor_torque_Nm, 0.0) << "at rest there is nothing to damp";
      }
    }
    input.reference_fresh = true;
    input.reference[0] = {0.5, 0.0, 0.0};
    const RobotOutput out = controller.Step(input);
    EXPECT_FALSE(out.stale);
    EXPECT_NEAR(out.joint[0].position_rad, end_rad, 1e-12) << "goes on without a jump";
  }
}

// A smooth reference of which every fourth sample is late is followed as if none were.
TEST(RobotController, LateReferencesLeaveTheMotionAsItIs) {
  RobotController late({RigConfig(Strategy::kPid)}), whole({RigConfig(Strategy::kPid)});
  RobotInput input = Still(0.0);
  input.reference_count = 1;
  for (int k = 0; k < 960; ++k) {
    const double t_s = kCycle_s * k, w = 2.5;
    input.reference[0] = {0.5 * std::sin(w * t_s), 0.5 * w * std::cos(w * t_s),
                          -0.5 * w * w * std::sin(w * t_s)};
    input.reference_fresh = true;
    const JointOutput expected = whole.Step(input).joint[0];
    input.reference_fresh = k % 4 != 3;
    const JointOutput out = late.Step(input).joint[0];
    EXPECT_NEAR(out.position_rad, expected.position_rad, 1e-6);
    EXPECT_NEAR(out.motor_torque_Nm, expected.motor_torque_Nm, 1e-5);
  }
}

// At rest with a network's feed-forward and an integral that is not empty; the motor's torque.
double SettleWithNetworkAndIntegral(RobotController* controller, RobotInput* input) {
  input->reference_count = 1;
  input->prediction_fresh = input->regime_fresh = true;
  input->regime[0] = types::Regime::kSea;
  input->prediction[0] = {.valid = true, .sea_torque_Nm = 2.0};
  input->reference[0].position_rad = 0.05;  // the integral fills
  for (int k = 0; k < 240; ++k) (void)controller->Step(*input);
  input->reference[0].position_rad = 0.0;
  for (int k = 0; k < 240; ++k) (void)controller->Step(*input);
  return controller->Step(*input).joint[0].motor_torque_Nm;
}

// A prediction or a regime that is late now and then takes nothing from the feed-forward, nor from
// the integral.
TEST(RobotController, LatePredictionsAndRegimesLeaveTheFeedForwardAsItIs) {
  RobotController controller({RigConfig(Strategy::kPidEsn)});
  RobotInput input = Still(0.0);
  const double before_Nm = SettleWithNetworkAndIntegral(&controller, &input);
  for (int k = 0; k < 960; ++k) {
    input.prediction_fresh = k % 5 > 1;
    input.regime_fresh = k % 7 > 0;
    const RobotOutput out = controller.Step(input);
    EXPECT_NEAR(out.joint[0].motor_torque_Nm, before_Nm, 1e-9);
    EXPECT_EQ(out.stale, !(input.prediction_fresh && input.regime_fresh));
  }
}

// One that comes a tick late every time is as good as one that stays away for a tick.
TEST(RobotController, APredictionThatIsAlwaysATickLateIsNotLost) {
  RobotController controller({RigConfig(Strategy::kPidEsn)});
  RobotInput input = Still(0.0);
  const double before_Nm = SettleWithNetworkAndIntegral(&controller, &input);
  input.prediction_fresh = input.regime_fresh = false;
  input.prediction_late_s = input.regime_late_s = kCycle_s;
  for (int k = 0; k < 240; ++k) {
    const RobotOutput out = controller.Step(input);
    EXPECT_NEAR(out.joint[0].motor_torque_Nm, before_Nm, 1e-9);
    EXPECT_TRUE(out.stale);
  }
  input.prediction_late_s = 2.0 * JointControlConfig{}.stale_grace_s;  // what comes is too old
  double without_Nm = 0.0;
  for (int k = 0; k < 240; ++k) without_Nm = controller.Step(input).joint[0].motor_torque_Nm;
  EXPECT_LT(without_Nm, 0.7 * before_Nm) << "no network";
}

// A reference that is always late is followed where it would be by now, also after a loss.
TEST(RobotController, AReferenceThatIsAlwaysATickLateIsFollowedWithoutALag) {
  RobotController late({RigConfig(Strategy::kPid)}), whole({RigConfig(Strategy::kPid)});
  RobotInput input = Still(0.0);
  input.reference_count = 1;
  const auto at = [](double t_s) {
    const double w = 2.5;
    return Point{0.5 * std::sin(w * t_s), 0.5 * w * std::cos(w * t_s),
                 -0.5 * w * w * std::sin(w * t_s)};
  };
  for (int k = 1; k < 960; ++k) {
    input.reference[0] = at(kCycle_s * k);
    input.reference_fresh = true;
    input.reference_late_s = kNoInput;
    const JointOutput expected = whole.Step(input).joint[0];
    if (k > 10) {
      input.reference_fresh = false;
      input.reference[0] = at(kCycle_s * (k - 1));
      input.reference_late_s = kCycle_s;
    }
    const JointOutput out = late.Step(input).joint[0];
    EXPECT_NEAR(out.position_rad, expected.position_rad, 1e-6);
    EXPECT_NEAR(out.motor_torque_Nm, expected.motor_torque_Nm, 1e-5);
  }
  input.reference_late_s = kNoInput;  // lost
  double last_rad = 0.0;
  for (int k = 0; k < 60; ++k) last_rad = late.Step(input).joint[0].position_rad;
  input.reference[0] = {last_rad + 0.2, 0.0, 0.0};
  input.reference_late_s = kCycle_s;
  EXPECT_NEAR(late.Step(input).joint[0].position_rad, last_rad, 1e-9) << "without a jump";
}

// Lost for longer, the feed-forward fades out; back, it leaves the integral what was its own.
TEST(RobotController, AFeedForwardThatWasLostLeavesTheIntegralItsOwn) {
  RobotController controller({RigConfig(Strategy::kPidEsn)});
  RobotInput input = Still(0.0);
  const double before_Nm = SettleWithNetworkAndIntegral(&controller, &input);
  input.prediction_fresh = false;
  double without_Nm = 0.0;
  for (int k = 0; k < 240; ++k) without_Nm = controller.Step(input).joint[0].motor_torque_Nm;
  EXPECT_LT(without_Nm, 0.7 * before_Nm) << "no network";
  input.prediction_fresh = true;
  double after_Nm = 0.0;
  for (int k = 0; k < 240; ++k) after_Nm = controller.Step(input).joint[0].motor_torque_Nm;
  EXPECT_NEAR(after_Nm, before_Nm, 1e-6);
}

TEST(RobotController, ALostPositionLeavesDampingByTheMotor) {
  const JointControlConfig config = RigConfig(Strategy::kPid);
  RobotController controller({config});
  static_cast<void>(controller.Step(Still(0.2)));
  RobotInput input = Still(0.2);
  input.joint[0].valid = false;
  input.joint[0].motor_velocity_rad_s = 100.0;
  RobotOutput out = controller.Step(input);
  EXPECT_TRUE(out.stale);
  EXPECT_NEAR(out.joint[0].motor_torque_Nm, -0.3 * 1.0 * config.shaft_per_output, 1e-12);
  input.joint[0].actuator_valid = false;
  out = controller.Step(input);
  EXPECT_EQ(out.joint[0].motor_torque_Nm, 0.0);
  EXPECT_TRUE(out.stale);
}

TEST(RobotController, ARobotOfAnotherNumberOfJointsIsNotCommanded) {
  RobotController controller({RigConfig(Strategy::kPid)});
  RobotInput input = Still(0.2);
  for (const int joints : {0, 2}) {
    input.joint_count = joints;
    const RobotOutput out = controller.Step(input);
    EXPECT_EQ(out.fault, Fault::kOtherRobot);
    EXPECT_EQ(out.joint_count, 1) << "its own, by which the robot knows it";
    EXPECT_EQ(out.joint[0].mode, types::ControlMode::kIdle);
  }
  input.joint_count = 1;
  EXPECT_EQ(controller.Step(input).fault, Fault::kNone);
}

// With a derivative gain alone the torque is - Kd x the velocity that was chosen.
TEST(RobotController, TakesTheVelocityFromTheSourceThatIsConfigured) {
  for (const VelocityFrom source : {VelocityFrom::kOutput, VelocityFrom::kMotor}) {
    JointControlConfig config = RigConfig(Strategy::kPid);
    config.pid = {.derivative_Nm_s_rad = 0.5, .anti_windup_s = 1.0};
    config.shaft_per_output = 0.01;
    config.takeover_s = 0.0;
    config.velocity_from = source;
    RobotController controller({config});
    RobotInput input = Still(0.1);
    input.reference_count = 1;
    input.reference[0] = {0.1, 0.0, 0.0};
    controller.Step(input);
    input.joint[0].velocity_rad_s = 0.2;
    input.joint[0].motor_velocity_rad_s = 30.0;
    input.joint[0].motor_position_rad = 77.0;
    const double velocity_rad_s = source == VelocityFrom::kMotor ? 30.0 / config.gear_ratio : 0.2;
    EXPECT_NEAR(controller.Step(input).joint[0].motor_torque_Nm, -0.01 * 0.5 * velocity_rad_s,
                1e-12);
  }
}

TEST(RobotController, DoesNotWindUpWhileTheProviderBridgesAGap) {
  RobotController controller({RigConfig(Strategy::kPid)});
  static_cast<void>(controller.Step(Still(0.0)));
  RobotInput away = Still(-0.1);
  away.interrupted = true;
  for (int k = 0; k < 2400; ++k) static_cast<void>(controller.Step(away));
  EXPECT_NEAR(controller.Step(Still(0.0)).joint[0].motor_torque_Nm, 0.0, 1e-12);
}

// The joint moves while the reference has not come yet. What a newcomer held since it started was
// the start of its way to the reference: up to 0.4 rad away when it was handed the robot.
TEST(RobotController, AStandbyThatHearsTheReferenceLateBeginsWhereTheJointIs) {
  RobotController standby({RigConfig(Strategy::kPid)});
  RobotInput input = Still(0.0);
  input.stands_by = true;
  static_cast<void>(standby.Step(input));
  for (int k = 1; k <= 30; ++k) {
    input.joint[0].position_rad = 0.01 * k;
    EXPECT_EQ(standby.Step(input).joint[0].position_rad, 0.01 * k);
  }
  input.reference_count = 1;
  input.reference_fresh = true;
  input.reference[0] = {0.301, 0.0, 0.0};
  EXPECT_NEAR(standby.Step(input).joint[0].position_rad, 0.3, 1e-4);

  RobotController owner({RigConfig(Strategy::kPid)});
  static_cast<void>(owner.Step(Still(0.0)));
  EXPECT_EQ(owner.Step(Still(0.01)).joint[0].position_rad, 0.0) << "who is obeyed holds";
}

// A standby was stopped for 1.5 s. The joint had gone on meanwhile, the first reference since then
// had not been read: the old target was too far away, and the fault stayed until disarmed.
TEST(RobotController, AStandbyWithAnOldTargetTakesTheReferenceUpAnew) {
  JointControlConfig config = RigConfig(Strategy::kPid);
  config.tracking_error_limit_rad = 0.6;
  config.takeover_s = 0.0;
  RobotController standby({config});
  RobotInput input = Still(0.0);
  input.stands_by = true;
  input.reference_count = 1;
  input.reference_fresh = true;
  input.reference_late_s = 0.0;
  input.reference[0] = {0.0, 0.0, 0.0};
  for (int k = 0; k < 10; ++k) ASSERT_EQ(standby.Step(input).fault, Fault::kNone);
  input.joint[0].position_rad = 0.9;
  input.reference_fresh = false;
  input.reference_late_s = 1.5;
  RobotOutput out = standby.Step(input);
  EXPECT_EQ(out.fault, Fault::kNone);
  EXPECT_EQ(out.joint[0].position_rad, 0.9) << "from where the joint is";
  input.reference_fresh = true;
  input.reference_late_s = 0.0;
  input.reference[0] = {0.91, 0.0, 0.0};
  static_cast<void>(standby.Step(input));
  input.stands_by = false;  // it is obeyed now
  EXPECT_NEAR(standby.Step(input).joint[0].position_rad, 0.91, 1e-12);
  input.joint[0].position_rad = 0.2;
  EXPECT_EQ(standby.Step(input).fault, Fault::kTrackingError) << "of its own commands it is one";
}

TEST(RobotController, AStandbyGoesOnFromTheOwnersCommand) {
  RobotController owner({RigConfig(Strategy::kPid)});
  RobotController standby({RigConfig(Strategy::kPid)});
  double applied_Nm = 0.0;
  for (int k = 0; k < 240; ++k) {
    applied_Nm = owner.Step(Still(k == 0 ? 0.0 : -0.05)).joint[0].motor_torque_Nm;
    if (k < 230) continue;  // the standby comes late: its integral would be another
    const double own_Nm = standby.Step(Still(k == 230 ? 0.0 : -0.05)).joint[0].motor_torque_Nm;
    standby.Follow(std::vector<double>{applied_Nm - own_Nm});
  }
  const double next_Nm = standby.Step(Still(-0.05)).joint[0].motor_torque_Nm;
  const double integral_step_Nm =
      10.0 * 0.05 * kCycle_s * RigConfig(Strategy::kPid).shaft_per_output;
  EXPECT_NEAR(next_Nm, applied_Nm + integral_step_Nm, 1e-12);
}

TEST(RobotController, ANewSessionStartsAnew) {
  RobotController controller({RigConfig(Strategy::kPid)});
  static_cast<void>(controller.Step(Still(0.4)));
  RobotInput input = Still(0.9);
  input.session_id = 8;
  const RobotOutput out = controller.Step(input);
  EXPECT_EQ(out.joint[0].position_rad, 0.9);
  EXPECT_EQ(out.joint[0].motor_torque_Nm, 0.0);
}

TEST(RobotController, PositionStrategyGivesTheDriveTheReference) {
  JointControlConfig config = RigConfig(Strategy::kPosition);
  config.takeover_s = 0.0;
  RobotController controller({config});
  RobotInput input = Still(0.4);
  input.reference_count = 1;
  input.reference[0] = {0.45, 0.3, 1.0};
  const RobotOutput out = controller.Step(input);
  EXPECT_EQ(out.joint[0].mode, types::ControlMode::kPosition);
  EXPECT_EQ(out.joint[0].position_rad, 0.45);
  EXPECT_EQ(out.joint[0].velocity_rad_s, 0.3);
}

TEST(RobotController, MovesSlowlyOnRequestAndOnlyWithoutAReference) {
  TestRig rig;
  rig.pneumatic_Nm = 0.0;
  RobotController controller({RigConfig(Strategy::kPid)});
  double fastest_rad_s = 0.0;
  for (int k = 0; k < 6 * 240; ++k) {
    RobotInput input = InputOf(rig);
    input.motion[0] = {types::Motion::kMoveSlowly, 0.3, 0.1, 0.0};
    const RobotOutput out = controller.Step(input);
    fastest_rad_s = std::max(fastest_rad_s, out.joint[0].velocity_rad_s);
    rig.Step(out.joint[0].motor_torque_Nm, kCycle_s);
  }
  EXPECT_NEAR(fastest_rad_s, 0.1, 1e-9);
  EXPECT_NEAR(rig.link_rad, 0.3, 0.02);
  RobotInput input = InputOf(rig);
  input.motion[0] = {types::Motion::kMoveSlowly, 0.3, 0.1, 0.0};
  input.reference_count = 1;
  input.reference[0] = {rig.encoder_rad() + 0.01, 0.0, 0.0};
  for (int k = 0; k < 240; ++k) static_cast<void>(controller.Step(input));
  EXPECT_NEAR(controller.Step(input).joint[0].position_rad, input.reference[0].position_rad, 1e-12);
}

TEST(RobotController, PushesAgainstTheChamberAtTheAskedSpeedAndTorque) {
  TestRig rig;
  rig.pneumatic_Nm = 0.3587 * 4.0;  // the chamber pushes up, the motor is asked down
  rig.link_rad = 0.5 * rig.play_rad;
  RobotController controller({RigConfig(Strategy::kPid)});
  double largest_Nm = 0.0, fastest_rad_s = 0.0;
  for (int k = 0; k < 8 * 240; ++k) {
    RobotInput input = InputOf(rig);
    input.motion[0] = {types::Motion::kPushAgainstChamber, -0.3, 0.1, 0.1};
    const RobotOutput out = controller.Step(input);
    largest_Nm = std::max(largest_Nm, std::abs(out.joint[0].motor_torque_Nm));
    rig.Step(out.joint[0].motor_torque_Nm, kCycle_s);
    if (k > 240) fastest_rad_s = std::max(fastest_rad_s, std::abs(rig.motor_rad_s));
  }
  EXPECT_LE(largest_Nm, 0.1);
  EXPECT_LT(fastest_rad_s, 0.25);
  EXPECT_NEAR(rig.motor_rad, -0.3, 0.02);
  EXPECT_NEAR(rig.link_rad, rig.motor_rad + 0.5 * rig.play_rad, 2e-3) << "the teeth touch";
}

TEST(RobotController, OrdersThatMakeNoSenseAreNotExecuted) {
  RobotController controller({RigConfig(Strategy::kPid)});
  for (const MotionOrder& order : {MotionOrder{types::Motion::kMoveSlowly, kNaN, 0.1, 0.0},
                                   MotionOrder{types::Motion::kMoveSlowly, 0.5, 0.0, 0.0},
                                   MotionOrder{types::Motion::kPushAgainstChamber, 0.5, -1.0, 0.0},
                                   MotionOrder{types::Motion::kMoveSlowly, 0.5, 0.1, kNaN}}) {
    RobotInput input = Still(0.2);
    input.motion[0] = order;
    const RobotOutput out = controller.Step(input);
    EXPECT_EQ(out.joint[0].position_rad, 0.2);
    EXPECT_EQ(out.joint[0].motor_torque_Nm, 0.0);
  }
}

// Mean squared error over the published benchmark: 30 degrees, four cycles in 10 s.
double BenchmarkMse(const JointControlConfig& config, TestRig rig) {
  RobotController controller({config});
  reference::GeneratorConfig generator_config;
  generator_config.trajectory = std::make_shared<reference::Sine>(reference::SineConfig{
      .amplitude_rad = std::numbers::pi / 6.0, .frequency_Hz = 0.4, .duration_s = 10.0});
  reference::Generator generator(generator_config);
  generator.Start(rig.encoder_rad());
  double sum = 0.0;
  int count = 0;
  for (int k = 0; k < 12 * 240; ++k) {
    RobotInput input = InputOf(rig);
    input.reference_count = 1;
    input.reference[0] = generator.At(k * kCycle_s);
    if (k >= 2 * 240) {
      const double error = input.reference[0].position_rad - rig.link_rad;
      sum += error * error;
      ++count;
    }
    rig.Step(controller.Step(input).joint[0].motor_torque_Nm, kCycle_s);
  }
  return sum / count;
}

TEST(ClosedLoop, EachStepOfKnowledgeTracksBetter) {
  const TestRig rig;
  JointControlConfig linear = RigConfig(Strategy::kPidLinear);
  linear.compensator.kind = CompensatorKind::kLinear;
  const double pid = BenchmarkMse(RigConfig(Strategy::kPid), rig);
  const double with_linear = BenchmarkMse(linear, rig);
  const double with_model = BenchmarkMse(RigConfig(Strategy::kPidLinear), rig);
  EXPECT_LT(pid, 0.02);
  EXPECT_LT(with_linear, 0.8 * pid);
  EXPECT_LT(with_model, 0.5 * with_linear);
  RecordProperty("pid", std::to_string(pid));
  RecordProperty("linear", std::to_string(with_linear));
  RecordProperty("model", std::to_string(with_model));
}

TEST(ClosedLoop, AnEffectAddedToTheModelFileImprovesTracking) {
  TestRig rig;
  rig.extra_viscous_up_Nm_s_rad = 0.6;
  const JointControlConfig declared = RigConfig(Strategy::kPidLinear);
  JointControlConfig corrected = declared;
  actuator::Term term =
      actuator::MakeTerm("direction_dependent_viscous", corrected.model->constants);
  for (actuator::ParameterValue& value : term.linear) value.value = 0.0;
  // Half of it is symmetric, half follows |v|: what the catalogue's effect adds is found by its
  // torque.
  term.linear[0].value = 1.0;
  corrected.model->terms.push_back(term);
  effects::JointSample up;
  up.velocity_rad_s = 1.0;
  up.motor_velocity_rad_s = 100.0;
  const int index = static_cast<int>(corrected.model->terms.size()) - 1;
  effects::JointSample down = up;
  down.velocity_rad_s = -1.0;
  down.motor_velocity_rad_s = -100.0;
  const double gain_up = corrected.model->TermTorque(index, up, {});
  const double gain_down = corrected.model->TermTorque(index, down, {});
  ASSERT_NE(gain_up, -gain_down);
  // c gain_up - 0.3 symmetric share = -0.6 upward, c gain_down + share = 0 downward.
  const double c = -0.6 / (gain_up + gain_down);
  const double share = -c * gain_down;
  corrected.model->terms[index].linear[0].value = c;
  AddTerm(&*corrected.model, "viscous", {share});
  EXPECT_LT(BenchmarkMse(corrected, rig), 0.6 * BenchmarkMse(declared, rig));
}

TEST(RobotController, AMillionStepsAllocateNothingAndStayBounded) {
  for (const Strategy strategy : {Strategy::kPidLinear, Strategy::kPidEsn}) {
    RobotController controller({RigConfig(strategy)});
    RobotInput input = Still(0.0);
    input.reference_count = 1;
    input.prediction_fresh = input.regime_fresh = true;
    const long before = test::Allocations();
    double largest_Nm = 0.0;
    for (int k = 0; k < 1000000; ++k) {
      const double phase = 0.01 * k;
      input.reference[0] = {0.5 * std::sin(phase), 1.2 * std::cos(phase), -2.88 * std::sin(phase)};
      input.joint[0].position_rad = 0.45 * std::sin(phase - 0.1);
      input.joint[0].velocity_rad_s = 1.08 * std::cos(phase - 0.1);
      input.regime[0] = static_cast<types::Regime>((k / 1000) % 3);
      input.prediction[0] = {true, std::cos(phase), std::sin(phase), 0.0};
      input.reference_fresh = k % 5000 > 10;
      input.motion[0].kind = k % 7000 > 6000 ? types::Motion::kHold : types::Motion::kNone;
      const RobotOutput out = controller.Step(input);
      ASSERT_EQ(out.fault, Fault::kNone) << k;
      largest_Nm = std::max(largest_Nm, std::abs(out.joint[0].motor_torque_Nm));
    }
    EXPECT_EQ(test::Allocations() - before, 0);
    EXPECT_LE(largest_Nm, 0.398);
  }
}

TEST(RobotController, BadConfigurationIsRefused) {
  EXPECT_THROW(RobotController({}), std::invalid_argument);
  EXPECT_THROW(RobotController(std::vector<JointControlConfig>(13, RigConfig(Strategy::kPid))),
               std::invalid_argument);
  JointControlConfig config = RigConfig(Strategy::kPid);
  config.motor_torque_limit_Nm = 0.0;
  EXPECT_THROW(RobotController({config}), std::invalid_argument);
  config = RigConfig(Strategy::kPidLinear);
  config.model.reset();
  EXPECT_THROW(RobotController({config}), std::invalid_argument);
  config = RigConfig(Strategy::kPid);
  config.shaft_per_output = kNaN;
  EXPECT_THROW(RobotController({config}), std::invalid_argument);
}

TEST(RobotController, AnotherGeneratorsReferenceIsReachedWithoutAStep) {
  RobotController controller({RigConfig(Strategy::kPid)});
  RobotInput input = Still(0.2);
  input.reference_count = 1;
  input.reference[0] = {0.2, 0.0, 0.0};
  for (int k = 0; k < 240; ++k) (void)controller.Step(input);
  const double before_Nm = controller.Step(input).joint[0].motor_torque_Nm;
  input.reference[0].position_rad = 0.5;
  input.reference_changed = true;
  RobotOutput out = controller.Step(input);
  EXPECT_NEAR(out.joint[0].position_rad, 0.2, 1e-3);
  EXPECT_NEAR(out.joint[0].motor_torque_Nm, before_Nm, 1e-3);
  input.reference_changed = false;
  for (int k = 0; k < 240; ++k) out = controller.Step(input);
  EXPECT_NEAR(out.joint[0].position_rad, 0.5, 1e-9);
}

// What was followed has moved on since the last cycle, by more when cycles were missed.
TEST(RobotController, AnotherGeneratorOfTheSameMotionLeavesNoOffset) {
  for (const int missed : {0, 2}) {
    RobotController controller({RigConfig(Strategy::kPid)});
    RobotInput input = Still(0.2);
    input.reference_count = 1;
    Point at{0.2, 1.3, -2.0};
    const auto step = [&](double period_s) {
      at = reference::Extrapolated(at, period_s);
      input.reference[0] = at;
      input.period_s = period_s;
      return controller.Step(input).joint[0].position_rad;
    };
    (void)step(kCycle_s);
    for (int k = 0; k < 240; ++k) (void)step(kCycle_s);
    input.reference_changed = true;
    EXPECT_NEAR(step((1 + missed) * kCycle_s), at.position_rad, 1e-12) << missed;
  }
}

TEST(RobotController, AnotherPredictorsTorqueFadesIn) {
  RobotController controller({RigConfig(Strategy::kPidEsn)});
  RobotInput input = Still(0.2);
  input.reference_count = 1;
  input.reference[0] = {0.2, 0.0, 0.0};
  input.prediction_fresh = input.regime_fresh = true;
  input.regime[0] = types::Regime::kSea;
  input.prediction[0] = {.valid = true, .sea_torque_Nm = 1.0};
  for (int k = 0; k < 240; ++k) (void)controller.Step(input);
  const double before_Nm = controller.Step(input).joint[0].compensation_Nm;
  input.prediction[0].sea_torque_Nm = 3.0;
  input.prediction_changed = true;
  RobotOutput out = controller.Step(input);
  // In a cycle a share of 1 - exp(-h / crossfade_s) of the difference.
  const JointControlConfig config = RigConfig(Strategy::kPidEsn);
  const double step_Nm = 2.0 * config.shaft_per_output;
  EXPECT_NEAR(out.joint[0].compensation_Nm - before_Nm,
              step_Nm * (1.0 - std::exp(-kCycle_s / config.crossfade_s)), 1e-9);
  input.prediction_changed = false;
  for (int k = 0; k < 240; ++k) out = controller.Step(input);
  EXPECT_NEAR(out.joint[0].compensation_Nm - before_Nm, step_Nm, 1e-9);
}

}  // namespace
}  // namespace sinew::control
