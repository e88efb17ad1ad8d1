// Limits of torque, velocity and position against virtual controllers on a bus in memory.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "components/base/types/angle.h"
#include "tests/bridge/joints/plant_bench.h"

namespace sinew::bridge {
namespace {

TEST(CanPlant, TorqueAndCurrentAreLimited) {
  Bench bench;
  bench.config.joints[0].limits.motor_torque_Nm = 0.02;
  bench.Start();
  bench.Arm();
  bench.command.motor_torque_Nm[0] = 5.0;
  bench.Steps(2);
  EXPECT_NEAR(bench.rotors.torque_Nm[0], 0.02, 1e-8);

  Bench other;
  other.config.joints[0].limits.current_A = 0.5;
  other.Start();
  other.Arm();
  other.command.motor_torque_Nm[0] = -5.0;
  other.Steps(2);
  EXPECT_NEAR(other.rotors.torque_Nm[0], -0.5 * test::Rotors::kTorqueConstant_Nm_A, 1e-8);
}

TEST(CanPlant, VelocityStaysBelowItsLimitUnderFullTorque) {
  Bench bench;
  bench.config.joints[0].limits.velocity_rad_s = 1.0;
  bench.config.joints[0].limits.upper_rad = 100.0;
  bench.Start();
  bench.Arm();
  bench.command.motor_torque_Nm[0] = 0.01;
  double fastest_rad_s = 0.0;
  for (int i = 0; i < 600; ++i) {
    bench.Step();
    fastest_rad_s = std::max(fastest_rad_s, bench.rotors.velocity_rad_s[0] / 100.0);
  }
  // The taper closes over the last tenth; one cycle (4.2 ms) of full torque adds 0.04 rad/s.
  EXPECT_LT(fastest_rad_s, 1.05);
  EXPECT_GT(fastest_rad_s, 0.85);
  EXPECT_FALSE(bench.faulty()) << bench.sensors.message;
}

TEST(CanPlant, NoTorqueOutwardsBeyondAPositionLimitButInwardsYes) {
  Bench bench;
  bench.config.joints[0].limits.upper_rad = 0.1;
  bench.rotors.angle_rad[0] = 15.0;  // 0.15 rad
  bench.Start();
  bench.Arm();
  bench.command.motor_torque_Nm[0] = 0.005;
  bench.Steps(3);
  EXPECT_EQ(bench.rotors.torque_Nm[0], 0.0);
  bench.command.motor_torque_Nm[0] = -0.005;
  bench.Steps(3);
  EXPECT_NEAR(bench.rotors.torque_Nm[0], -0.005, 1e-8);
}

// The whole chain: encoders on the bus, commands back, drives that follow as well as they do. The
// rotors' own 0.1 kg m^2 is the lightest inertia.
class BrakedOnTheBus : public testing::TestWithParam<ControlMode> {};

TEST_P(BrakedOnTheBus, FullCommandsTowardsALimitStopThere) {
  Bench bench;
  JointLimits& limits = bench.config.joints[0].limits;
  limits.motor_torque_Nm = 0.1;  // 100 rad/s^2
  limits.braking = Braking{0.1, 0.25, 2.0};
  limits.lower_rad = -0.8;
  limits.upper_rad = 0.8;
  bench.Start();
  bench.Arm(GetParam());
  bench.command.motor_torque_Nm[0] = 9.0;
  bench.command.velocity_rad_s[0] = 9.0;
  bench.command.position_rad[0] = 9.0;
  double highest_rad = -1.0, fastest_rad_s = 0.0;
  for (int i = 0; i < 240 * 3; ++i) {
    bench.Step();
    highest_rad = std::max(highest_rad, bench.rotors.angle_rad[0] / 100.0);
    fastest_rad_s = std::max(fastest_rad_s, bench.rotors.velocity_rad_s[0] / 100.0);
    ASSERT_FALSE(bench.faulty()) << bench.sensors.message;
  }
  EXPECT_GT(fastest_rad_s, 3.0) << "it came fast";
  // The drives' own loops lag by some milliseconds in position and velocity mode: 0.02 rad.
  const double allowed_rad = GetParam() == ControlMode::kTorque ? 1e-3 : 0.02;
  EXPECT_LT(highest_rad, 0.8 + allowed_rad);
  EXPECT_GT(highest_rad, 0.75) << "but it gets there";
  EXPECT_NEAR(bench.rotors.velocity_rad_s[0], 0.0, 0.05);
}

INSTANTIATE_TEST_SUITE_P(Modes, BrakedOnTheBus,
                         testing::Values(ControlMode::kTorque, ControlMode::kVelocity,
                                         ControlMode::kPosition));

TEST(CanPlant, WithoutCommandAJointThatRunsToItsLimitIsBraked) {
  Bench bench;
  JointLimits& limits = bench.config.joints[0].limits;
  limits.braking = Braking{0.1, 0.25, 2.0};
  bench.Start();
  bench.Arm();
  bench.rotors.velocity_rad_s[0] = 390.0;  // 3.9 rad/s, thrown
  double highest_rad = -1.0;
  for (int i = 0; i < 240 * 3; ++i) {
    bench.Step();
    highest_rad = std::max(highest_rad, bench.rotors.angle_rad[0] / 100.0);
  }
  EXPECT_GT(highest_rad, 1.3) << "not before it must";
  EXPECT_LT(highest_rad, 1.501);
  EXPECT_FALSE(bench.faulty()) << bench.sensors.message;
}

TEST(CanPlant, PositionModeLeavesTheMeasuredPositionWithoutAJumpAndNoFasterThanTheLimit) {
  Bench bench;
  bench.config.joints[0].limits.velocity_rad_s = 0.5;
  bench.rotors.angle_rad[0] = 50.0;  // 0.5 rad
  bench.Start();
  double last_rev = 50.0 / types::kTwoPi;
  bool first = true;
  const double most_rev = 0.5 * kPeriod_s * 100.0 / types::kTwoPi;
  bench.buses[0]->OnFrame([&](const can::Delivery& d) {
    if (const auto p = can::Decode<can::SetInputPos>(d.frame)) {
      EXPECT_LE(std::abs(p->position_rev - last_rev), most_rev * 1.001 + 1e-5)
          << (first ? "first" : "later");
      last_rev = p->position_rev;
      first = false;
    }
  });
  bench.command.position_rad[0] = -9.0;  // beyond the limit as well
  bench.Arm(ControlMode::kPosition);
  bench.Steps(240 * 6);
  EXPECT_FALSE(first);
  EXPECT_NEAR(bench.rotors.angle_rad[0] / 100.0, -1.5, 0.01) << "held at lower_rad";
  EXPECT_FALSE(bench.faulty()) << bench.sensors.message;
}

TEST(CanPlant, VelocityModeIsLimited) {
  Bench bench;
  bench.config.joints[0].limits.velocity_rad_s = 0.5;
  bench.Start();
  bench.command.velocity_rad_s[0] = 3.0;
  bench.Arm(ControlMode::kVelocity);
  bench.Steps(60);
  EXPECT_NEAR(bench.rotors.velocity_rad_s[0] / 100.0, 0.5, 0.05);
}

}  // namespace
}  // namespace sinew::bridge
