// Oracles: finite differences across the joins, the trajectory itself after the soft start.
#include "components/robot/reference/generator.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <stdexcept>

#include "components/robot/reference/robot_reference.h"
#include "tests/support/allocations.h"

namespace sinew::reference {
namespace {

constexpr double kPeriod_s = 1.0 / 240.0;

GeneratorConfig BenchmarkSine() {
  GeneratorConfig config;
  config.trajectory = std::make_shared<Sine>(
      SineConfig{.amplitude_rad = 0.5236, .frequency_Hz = 0.4, .duration_s = 10.0});
  return config;
}

TEST(Generator, StartsAtRestWhereTheJointStandsAndIsOnTheTrajectoryAfterwards) {
  Generator generator(BenchmarkSine());
  generator.Start(-1.2);
  EXPECT_EQ(generator.At(0.0).position_rad, -1.2);
  EXPECT_EQ(generator.At(0.0).velocity_rad_s, 0.0);
  EXPECT_EQ(generator.At(0.0).acceleration_rad_s2, 0.0);
  for (double t = 2.0; t < 12.0; t += 0.1) {
    EXPECT_EQ(generator.At(t).position_rad, BenchmarkSine().trajectory->At(t - 2.0).position_rad);
  }
  EXPECT_FALSE(generator.Finished(12.9));
  EXPECT_TRUE(generator.Finished(13.0));
  EXPECT_EQ(generator.At(14.0).velocity_rad_s, 0.0);
  EXPECT_NEAR(generator.At(14.0).position_rad, 0.0, 1e-12);
}

TEST(Generator, IsSmoothFromTheFirstTickToTheLast) {
  Generator generator(BenchmarkSine());
  generator.Start(0.7);
  constexpr double kStep_s = 1e-4;
  for (double t = -0.01; t < 14.0; t += 0.00731) {
    const Point p = generator.At(t), before = generator.At(t - kStep_s),
                after = generator.At(t + kStep_s);
    EXPECT_NEAR(p.velocity_rad_s, (after.position_rad - before.position_rad) / (2 * kStep_s), 1e-5)
        << t;
    EXPECT_NEAR(p.acceleration_rad_s2,
                (after.velocity_rad_s - before.velocity_rad_s) / (2 * kStep_s), 1e-2)
        << t;
  }
}

TEST(Generator, TakesLongerWhenTheWayIsTooFarForTheLimits) {
  GeneratorConfig config;
  config.trajectory = std::make_shared<Hold>(2.0);
  config.limits.velocity_rad_s = 0.5;
  Generator generator(config);
  generator.Start(2.0);
  EXPECT_EQ(generator.soft_start_s(), config.soft_start_s);
  generator.Start(0.0);
  EXPECT_GE(generator.soft_start_s(),
            1.875 * 2.0 / 0.5 * 0.999);  // peak speed of the quintic: 1.875 way / T
  EXPECT_LE(generator.soft_start_s(), 1.875 * 2.0 / 0.5 * 1.25);
}

TEST(Generator, BadConfigurationIsRefused) {
  GeneratorConfig config;
  EXPECT_THROW(Generator{config}, std::invalid_argument);
  config = BenchmarkSine();
  config.soft_start_s = -1.0;
  EXPECT_THROW(Generator{config}, std::invalid_argument);
  config = BenchmarkSine();
  config.soft_stop_s = std::nan("");
  EXPECT_THROW(Generator{config}, std::invalid_argument);
  EXPECT_THROW(RobotReference({}), std::invalid_argument);
}

struct Robot {
  std::array<double, 2> position{0.3, -0.2};
  std::array<bool, 2> valid{true, true};
  RobotReferenceInput At(std::uint64_t tick, bool may_move) const {
    RobotReferenceInput input;
    input.session_id = 5;
    input.tick = tick;
    input.period_s = kPeriod_s;
    input.may_move = may_move;
    input.joint_count = 2;
    input.position_rad = position;
    input.valid = valid;
    return input;
  }
};

RobotReferenceConfig TwoJoints() { return {.joints = {BenchmarkSine(), BenchmarkSine()}}; }

TEST(RobotReference, AsksForNothingBeforeItIsArmed) {
  RobotReference reference(TwoJoints());
  const Robot robot;
  for (std::uint64_t k = 0; k < 100; ++k) {
    const RobotReferenceOutput out = reference.Step(robot.At(k, false));
    EXPECT_TRUE(out.idle);
    EXPECT_EQ(out.joint[1].position_rad, -0.2);
  }
}

TEST(RobotReference, StartsFromTheMeasuredPositionAndDependsOnTicksOnly) {
  RobotReference reference(TwoJoints());
  RobotReference other(TwoJoints());
  Robot robot;
  static_cast<void>(reference.Step(robot.At(9, false)));
  RobotReferenceOutput out = reference.Step(robot.At(10, true));
  EXPECT_FALSE(out.idle);
  EXPECT_EQ(out.joint[0].position_rad, 0.3);
  EXPECT_EQ(out.joint[1].position_rad, -0.2);
  static_cast<void>(other.Step(robot.At(10, true)));
  robot.position = {9.0, 9.0};  // where it is later does not matter
  for (std::uint64_t k = 11; k < 1000; ++k) out = reference.Step(robot.At(k, true));
  const RobotReferenceOutput jumped = other.Step(robot.At(999, true));  // ticks missed in between
  EXPECT_EQ(out.joint[0].position_rad, jumped.joint[0].position_rad);
  EXPECT_EQ(out.joint[1].acceleration_rad_s2, jumped.joint[1].acceleration_rad_s2);
}

TEST(RobotReference, WaitsForTheDelayAndForTheOperator) {
  RobotReferenceConfig config = TwoJoints();
  config.start_delay_s = 1.0;
  RobotReference delayed(config);
  config.start = StartRule::kOperator;
  config.start_delay_s = 0.0;
  RobotReference asked(config);
  const Robot robot;
  for (std::uint64_t k = 0; k < 1000; ++k) {
    EXPECT_EQ(delayed.Step(robot.At(k, true)).idle, k < 240) << k;
    RobotReferenceInput input = robot.At(k, true);
    input.operator_start = k == 500;
    EXPECT_EQ(asked.Step(input).idle, k < 500) << k;
  }
  RobotReferenceInput stop = robot.At(1000, true);
  stop.operator_stop = true;
  EXPECT_TRUE(asked.Step(stop).idle);
  EXPECT_TRUE(delayed.Step(stop).idle);
  EXPECT_TRUE(asked.Step(robot.At(1001, true)).idle);
  for (std::uint64_t k = 1001; k < 1600; ++k) {
    EXPECT_TRUE(delayed.Step(robot.At(k, true)).idle) << "stopped until it is armed again";
  }
}

TEST(RobotReference, HoldsWhereTheJointsStandBeforeItMoves) {
  RobotReferenceConfig config = TwoJoints();
  RobotReference at_once(config);
  config.start_delay_s = 0.5;
  config.hold_s = 1.0;
  RobotReference holds(config);
  Robot robot;
  for (std::uint64_t k = 0; k < 360; ++k) {
    const RobotReferenceOutput out = holds.Step(robot.At(k, true));
    EXPECT_EQ(out.idle, k < 120) << k;
    EXPECT_FALSE(out.finished) << k;
    EXPECT_EQ(out.joint[0].position_rad, 0.3) << k;
    EXPECT_EQ(out.joint[0].velocity_rad_s, 0.0) << k;
    if (k == 120) robot.position = {0.4, -0.3};  // it sags: what is asked stays
  }
  // From what was held, as another one starts from where it is.
  robot.position = {0.3, -0.2};
  for (std::uint64_t k = 0; k < 500; ++k) {
    const RobotReferenceOutput now = at_once.Step(robot.At(k, true));
    EXPECT_EQ(holds.Step(robot.At(360 + k, true)).joint[1].position_rad, now.joint[1].position_rad);
  }
  EXPECT_TRUE(holds.Step(robot.At(860, false)).idle);
  EXPECT_TRUE(holds.Step(robot.At(861, true)).idle) << "armed anew: the delay begins again";
  config.hold_s = -1.0;
  EXPECT_THROW(RobotReference{config}, std::invalid_argument);
}

TEST(RobotReference, ADisarmedRobotStartsAnewAndSoDoesANewSession) {
  RobotReference reference(TwoJoints());
  Robot robot;
  for (std::uint64_t k = 0; k < 500; ++k) static_cast<void>(reference.Step(robot.At(k, true)));
  EXPECT_TRUE(reference.Step(robot.At(500, false)).idle);
  robot.position = {0.05, 0.06};
  EXPECT_EQ(reference.Step(robot.At(501, true)).joint[0].position_rad, 0.05);
  for (std::uint64_t k = 502; k < 900; ++k) static_cast<void>(reference.Step(robot.At(k, true)));
  RobotReferenceInput input = robot.At(0, true);
  input.session_id = 6;
  EXPECT_EQ(reference.Step(input).joint[1].position_rad, 0.06);
}

TEST(RobotReference, DoesNotStartFromAPositionItDoesNotKnow) {
  RobotReference reference(TwoJoints());
  Robot robot;
  robot.position[0] = std::nan("");
  EXPECT_TRUE(reference.Step(robot.At(0, true)).stale);
  EXPECT_TRUE(reference.Step(robot.At(1, true)).idle);
  robot.position[0] = 0.1;
  robot.valid[1] = false;
  EXPECT_TRUE(reference.Step(robot.At(2, true)).stale);
  robot.valid[1] = true;
  EXPECT_FALSE(reference.Step(robot.At(3, true)).idle);
}

TEST(RobotReference, AMillionStepsAllocateNothingAndStayInBounds) {
  RobotReferenceConfig config = TwoJoints();
  config.joints[0].trajectory =
      std::make_shared<Sine>(SineConfig{.amplitude_rad = 0.5, .frequency_Hz = 0.4});
  RobotReference reference(config);
  const Robot robot;
  const long before = test::Allocations();
  double largest = 0.0;
  for (std::uint64_t k = 0; k < 1000000; ++k) {
    largest = std::max(largest, std::abs(reference.Step(robot.At(k, true)).joint[0].position_rad));
  }
  EXPECT_EQ(test::Allocations() - before, 0);
  EXPECT_LE(largest, 0.5);
}

}  // namespace
}  // namespace sinew::reference
