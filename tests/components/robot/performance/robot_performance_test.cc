// A robot's totals are those of its joints; on a common supply one joint uses what another returns.
#include "components/robot/performance/robot_performance.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "tests/support/allocations.h"

namespace sinew::performance {
namespace {

constexpr double kRobotPeriod_s = 1.0 / 240.0;

RobotPerformanceConfig TwoJoints() {
  RobotPerformanceConfig config;
  config.joints.resize(2);
  for (auto& joint : config.joints) joint.motor = {0.12, 0.0159, 100.0};
  config.mass_kg = 17.1;
  return config;
}

JointSample Turning(double velocity_rad_s) {
  return {.reference_rad = 0.1,
          .position_rad = 0.0,
          .velocity_rad_s = velocity_rad_s,
          .torque_Nm = 2.0,
          .current_A = 5.0};
}

TEST(RobotPerformance, LetsOneJointUseWhatAnotherReturns) {
  RobotPerformance robot(TwoJoints(), 0.01);
  RobotPerformanceOutput out;
  for (std::uint64_t tick = 0; tick <= 100; ++tick) {
    out = robot.Step(tick, std::array{Turning(1.0), Turning(-0.8)});
  }
  const double first_J = 3.0 + 7.95, second_J = 3.0 - 0.8 * 7.95;
  EXPECT_NEAR(out.energies.electrical_net_J, first_J + second_J, 1e-10);
  EXPECT_NEAR(out.energies.electrical_drawn_J, first_J, 1e-10);
  EXPECT_NEAR(out.drawn_J, first_J + second_J, 1e-10);
  EXPECT_NEAR(out.energies.net_J, 0.4, 1e-12);
  EXPECT_NEAR(out.energies.positive_J, 2.0, 1e-12);
  EXPECT_NEAR(out.mean_square_error_rad2, 0.01, 1e-15);
}

// A robot without losses that squats: gravity is the only load, so the net work of a whole number
// of cycles is 0 and the positive work is the lifting bound.
TEST(RobotPerformance, DoesTheLiftingBoundAsPositiveWorkWhenNothingIsLost) {
  RobotPerformance robot(TwoJoints(), kRobotPeriod_s);
  RobotPerformanceOutput out;
  const double w_rad_s = 2.0 * std::numbers::pi * 0.2;
  for (std::uint64_t tick = 0; tick <= 2400; ++tick) {
    const double t_s = static_cast<double>(tick) * kRobotPeriod_s;
    // Both joints carry half of m (g + h'') with a lever of 1 m.
    const double height_m = 0.45 + 0.2 * std::cos(w_rad_s * t_s);
    const double speed_m_s = -0.2 * w_rad_s * std::sin(w_rad_s * t_s);
    const double lift_m_s2 = 9.81 - 0.2 * w_rad_s * w_rad_s * std::cos(w_rad_s * t_s);
    const JointSample half{.reference_rad = 0.0,
                           .position_rad = 0.0,
                           .velocity_rad_s = speed_m_s,
                           .torque_Nm = 0.5 * 17.1 * lift_m_s2};
    out = robot.Step(tick, std::array{half, half}, height_m);
  }
  EXPECT_NEAR(out.lifting_J, 134.2, 0.1);
  EXPECT_NEAR(out.energies.net_J, 0.0, 1e-9);
  EXPECT_GE(out.energies.positive_J, out.lifting_J - 0.02);
  EXPECT_NEAR(out.energies.positive_J, out.lifting_J, 0.02);
  EXPECT_EQ(out.drawn.integrated, 0u);  // no current was measured
  EXPECT_EQ(out.drawn_J, 0.0);
}

TEST(RobotPerformance, CountsAMissingJointAsNotMeasured) {
  RobotPerformance robot(TwoJoints(), 0.01);
  RobotPerformanceOutput out;
  for (std::uint64_t tick = 0; tick < 10; ++tick) {
    out = robot.Step(tick, std::array{Turning(1.0)}, 0.5);
  }
  EXPECT_EQ(out.joint[1].error_lost, 10u);
  EXPECT_EQ(out.drawn.pending, 9u);
  EXPECT_NEAR(out.mean_square_error_rad2, 0.01, 1e-15);  // of the joint that was measured
}

TEST(RobotPerformance, AllocatesNothingInAStepAndLeavesOldTicksOut) {
  RobotPerformance robot(TwoJoints(), 0.01);
  const std::array samples{Turning(1.0), Turning(1.0)};
  const long before = test::Allocations();
  for (std::uint64_t tick = 0; tick < 1000; ++tick) robot.Step(tick, samples, 0.5);
  const double drawn_J = robot.Step(1000, samples, 0.5).drawn_J;
  EXPECT_EQ(robot.Step(1000, samples, 9.0).drawn_J, drawn_J);
  EXPECT_EQ(robot.Step(12, samples, 0.1).rise_m, 0.0);
  EXPECT_EQ(test::Allocations(), before);
}

TEST(RobotPerformance, RefusesFiguresOutOfRange) {
  RobotPerformanceConfig none = TwoJoints(), many = TwoJoints(), light = TwoJoints();
  none.joints.clear();
  many.joints.resize(13);
  light.mass_kg = 0.0;
  for (const auto& config : {none, many, light}) {
    EXPECT_THROW(RobotPerformance(config, 0.01), std::invalid_argument);
  }
}

}  // namespace
}  // namespace sinew::performance
