// The strategy computed_torque: PD and the torque prediction.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "components/base/types/control_mode.h"
#include "components/robot/control/robot_controller.h"
#include "tests/support/rig_constants.h"

namespace sinew::control {
namespace {

constexpr double kKp = 25.0, kKd = 0.4, kShaft = 1.0 / 75.0;

JointControlConfig ComputedTorque() {
  JointControlConfig config;
  config.strategy = Strategy::kComputedTorque;
  config.pid = {.proportional_Nm_rad = kKp, .derivative_Nm_s_rad = kKd};
  config.gear_ratio = 100.0;
  config.shaft_per_output = kShaft;
  config.motor_torque_limit_Nm = 0.4;
  config.takeover_s = config.crossfade_s = 0.0;
  return config;
}

RobotInput InputAt(double position_rad, double velocity_rad_s, double prediction_Nm) {
  RobotInput input;
  input.session_id = 3;
  input.period_s = kCycle_s;
  input.armed = true;
  input.joint_count = 1;
  input.joint[0].valid = input.joint[0].actuator_valid = true;
  input.joint[0].position_rad = position_rad;
  input.joint[0].velocity_rad_s = velocity_rad_s;
  input.reference_fresh = input.prediction_fresh = true;
  input.prediction[0] = {true, -99.0, 99.0, prediction_Nm};  // SEA and PEA must not be read
  return input;
}

TEST(ComputedTorque, IsPdAndThePredictionWithoutARegime) {
  RobotController controller({ComputedTorque()});
  RobotInput input = InputAt(0.3, -0.5, 8.0);
  input.reference_count = 1;
  input.reference[0] = {0.35, 0.25, 4.0};
  for (int k = 0; k < 100; ++k) {  // the same in every tick: nothing is summed up
    const RobotOutput out = controller.Step(input);
    EXPECT_NEAR(out.joint[0].motor_torque_Nm, kShaft * (kKp * 0.05 + kKd * 0.75 + 8.0), 1e-12);
    EXPECT_NEAR(out.joint[0].compensation_Nm, kShaft * 8.0, 1e-12);
    EXPECT_FALSE(out.stale);
  }
}

TEST(ComputedTorque, AlsoHoldsWithThePrediction) {
  for (const Strategy strategy : {Strategy::kComputedTorque, Strategy::kPidEsn}) {
    JointControlConfig config = ComputedTorque();
    config.strategy = strategy;
    config.by_regime = false;
    RobotController controller({config});
    const RobotOutput out = controller.Step(InputAt(0.3, 0.0, 8.0));  // the reference is idle
    const double expected_Nm = strategy == Strategy::kComputedTorque ? 8.0 : 0.0;
    EXPECT_NEAR(out.joint[0].motor_torque_Nm, kShaft * expected_Nm, 1e-12);
    EXPECT_EQ(out.joint[0].position_rad, 0.3);
  }
}

TEST(ComputedTorque, AMotionOrderIsFollowedWithoutThePrediction) {
  RobotController controller({ComputedTorque()});
  RobotInput input = InputAt(0.3, 0.0, 8.0);
  (void)controller.Step(input);
  input.motion[0] = {types::Motion::kMoveSlowly, 0.5, 0.1, 0.0};
  EXPECT_EQ(controller.Step(input).joint[0].compensation_Nm, 0.0);
}

TEST(ComputedTorque, ALostPredictionLeavesThePd) {
  const JointControlConfig config = ComputedTorque();
  RobotController controller({config});
  RobotInput input = InputAt(0.3, 0.0, 8.0);
  input.reference_count = 1;
  input.reference[0] = {0.35, 0.0, 0.0};
  (void)controller.Step(input);
  input.prediction_fresh = false;
  const int grace_ticks = static_cast<int>(config.stale_grace_s / kCycle_s);
  for (int k = 1; k <= grace_ticks; ++k) {
    const RobotOutput out = controller.Step(input);
    EXPECT_TRUE(out.stale);
    EXPECT_NEAR(out.joint[0].motor_torque_Nm, kShaft * (kKp * 0.05 + 8.0), 1e-12) << k;
  }
  EXPECT_NEAR(controller.Step(input).joint[0].motor_torque_Nm, kShaft * kKp * 0.05, 1e-12);
}

TEST(ComputedTorque, APredictionThatIsNoNumberIsLeftOutAndReported) {
  RobotController controller({ComputedTorque()});
  RobotInput input = InputAt(0.3, 0.0, std::nan(""));
  input.reference_count = 1;
  input.reference[0] = {0.35, 0.0, 0.0};
  const RobotOutput out = controller.Step(input);
  EXPECT_EQ(out.fault, Fault::kNonFinitePrediction);
  EXPECT_NEAR(out.joint[0].motor_torque_Nm, kShaft * kKp * 0.05, 1e-12);
}

TEST(ComputedTorque, RefusesAnIntegral) {
  JointControlConfig config = ComputedTorque();
  config.pid.integral_Nm_rad_s = 1.0;
  EXPECT_THROW(RobotController({config}), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::control
