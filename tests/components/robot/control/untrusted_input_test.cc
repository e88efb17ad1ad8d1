// Numbers that are not finite, or too large, come from the wire: no command repeats them.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "components/base/types/control_mode.h"
#include "components/robot/control/robot_controller.h"

namespace sinew::control {
namespace {

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
constexpr double kHuge = 1.7e308;

JointControlConfig AnyPid() {
  JointControlConfig config;
  config.strategy = Strategy::kPid;
  config.pid = {.proportional_Nm_rad = 12.0, .integral_Nm_rad_s = 10.0};
  config.gear_ratio = 100.0;
  config.shaft_per_output = 0.013;
  config.motor_torque_limit_Nm = 0.398;
  return config;
}

RobotInput StandingAt(double position_rad) {
  RobotInput input;
  input.session_id = 7;
  input.period_s = 1.0 / 240.0;
  input.armed = true;
  input.joint_count = 1;
  input.joint[0].valid = input.joint[0].actuator_valid = true;
  input.joint[0].position_rad = position_rad;
  return input;
}

void ExpectFinite(const RobotOutput& output) {
  for (const JointOutput& joint : output.joint) {
    EXPECT_TRUE(std::isfinite(joint.motor_torque_Nm)) << joint.motor_torque_Nm;
    EXPECT_TRUE(std::isfinite(joint.position_rad)) << joint.position_rad;
    EXPECT_TRUE(std::isfinite(joint.velocity_rad_s)) << joint.velocity_rad_s;
  }
}

TEST(UntrustedInput, ADisarmedRobotsCommandRepeatsOnlyFinitePositions) {
  RobotController controller({AnyPid()});
  RobotInput input = StandingAt(kNotANumber);
  input.armed = false;
  ExpectFinite(controller.Step(input));
  input.joint[0].position_rad = 0.4;
  EXPECT_EQ(controller.Step(input).joint[0].position_rad, 0.4);
}

TEST(UntrustedInput, ALostPositionThatIsNotANumberIsDampedAllTheSame) {
  RobotController controller({AnyPid()});
  ExpectFinite(controller.Step(StandingAt(0.4)));
  RobotInput lost = StandingAt(kNotANumber);
  lost.joint[0].valid = false;
  lost.joint[0].motor_velocity_rad_s = 100.0;
  const RobotOutput output = controller.Step(lost);
  ExpectFinite(output);
  EXPECT_EQ(output.fault, Fault::kNone);
  EXPECT_EQ(output.joint[0].mode, types::ControlMode::kTorque);
  EXPECT_LT(output.joint[0].motor_torque_Nm, 0.0);
}

TEST(UntrustedInput, AReferenceThatOverflowsWithTheStepToItIsAFault) {
  RobotController controller({AnyPid()});
  RobotInput input = StandingAt(0.4);
  input.reference_fresh = true;
  input.reference_count = 1;
  input.reference[0] = {kHuge, 0.0, 0.0};
  ExpectFinite(controller.Step(input));
  input.reference[0] = {-kHuge, 0.0, 0.0};
  const RobotOutput output = controller.Step(input);
  ExpectFinite(output);
  EXPECT_EQ(output.fault, Fault::kNonFiniteReference);
  EXPECT_EQ(output.joint[0].mode, types::ControlMode::kIdle);
}

}  // namespace
}  // namespace sinew::control
