// Limits against their law, on both sides of every bound.
#include "bridge/joints/limiter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace sinew::bridge {
namespace {

constexpr double kTorqueConstant_Nm_A = 0.02;
// Torque 0.4 Nm, current 10 A (0.2 Nm), 2 rad/s, -1 to 1.5 rad.
const JointLimits kLimits{0.4, 10.0, 2.0, -1.0, 1.5, 0.2, 90.0};

double Torque(const MeasuredMotion& measured, double torque_Nm) {
  return LimitTorque(kLimits, kTorqueConstant_Nm_A, measured, torque_Nm);
}

TEST(LimitTorque, PassesATorqueWithinTheLimits) {
  for (const double torque_Nm : {-0.2, -0.1, 0.0, 0.1, 0.2}) {
    EXPECT_EQ(Torque({0.0, 0.0}, torque_Nm), torque_Nm);
  }
}

TEST(LimitTorque, TheSmallerOfTorqueAndCurrentLimitCounts) {
  EXPECT_EQ(Torque({0.0, 0.0}, 0.3), 0.2) << "the current's";
  EXPECT_EQ(Torque({0.0, 0.0}, -0.3), -0.2);
  JointLimits weak = kLimits;
  weak.motor_torque_Nm = 0.05;
  EXPECT_EQ(LimitTorque(weak, kTorqueConstant_Nm_A, {0.0, 0.0}, 0.3), 0.05) << "the torque's";
}

TEST(LimitTorque, TapersOverTheLastTenthOfTheVelocityLimitInTheDirectionOfMotion) {
  // Begin, middle and end of the taper: 1.8, 1.9 and 2 rad/s. Tolerance: rounding of 1.9.
  EXPECT_DOUBLE_EQ(Torque({1.8, 0.0}, 0.1), 0.1);
  EXPECT_NEAR(Torque({1.9, 0.0}, 0.1), 0.05, 1e-15);
  EXPECT_EQ(Torque({2.0, 0.0}, 0.1), 0.0);
  EXPECT_EQ(Torque({3.0, 0.0}, 0.1), 0.0) << "never the other sign";
  EXPECT_NEAR(Torque({-1.9, 0.0}, -0.1), -0.05, 1e-15);
  EXPECT_EQ(Torque({-3.0, 0.0}, -0.1), 0.0);
}

TEST(LimitTorque, BrakingTorqueIsNotTapered) {
  EXPECT_EQ(Torque({3.0, 0.0}, -0.1), -0.1);
  EXPECT_EQ(Torque({-3.0, 0.0}, 0.1), 0.1);
}

TEST(LimitTorque, NothingOutwardsBeyondAPositionLimitButInwards) {
  EXPECT_EQ(Torque({0.0, 1.6}, 0.1), 0.0);
  EXPECT_EQ(Torque({0.0, 1.6}, -0.1), -0.1);
  EXPECT_EQ(Torque({0.0, -1.1}, -0.1), 0.0);
  EXPECT_EQ(Torque({0.0, -1.1}, 0.1), 0.1);
  EXPECT_EQ(Torque({0.0, 1.5}, 0.1), 0.1) << "at the limit is within it";
  EXPECT_EQ(Torque({0.0, -1.0}, -0.1), -0.1);
}

// For any input: no larger than commanded, never of the other sign, mirrored when all is mirrored.
TEST(LimitTorque, NeverAddsAndIsSymmetric) {
  const JointLimits symmetric{0.4, 10.0, 2.0, -1.5, 1.5, 0.2, 90.0};
  std::mt19937 random(3);
  std::uniform_real_distribution<double> torque(-0.6, 0.6), velocity(-3.0, 3.0), angle(-2.0, 2.0);
  for (int i = 0; i < 10'000; ++i) {
    const double commanded_Nm = torque(random);
    const MeasuredMotion measured{velocity(random), angle(random)};
    const double limited_Nm = LimitTorque(symmetric, kTorqueConstant_Nm_A, measured, commanded_Nm);
    ASSERT_LE(std::abs(limited_Nm), std::min(std::abs(commanded_Nm), 0.2));
    ASSERT_GE(limited_Nm * commanded_Nm, 0.0);
    ASSERT_EQ(LimitTorque(symmetric, kTorqueConstant_Nm_A,
                          {-measured.velocity_rad_s, -measured.position_rad}, -commanded_Nm),
              -limited_Nm);
  }
}

TEST(LimitVelocity, ClampsAndStopsOutwardsBeyondAPositionLimit) {
  EXPECT_EQ(LimitVelocity(kLimits, 0.0, 1.0), 1.0);
  EXPECT_EQ(LimitVelocity(kLimits, 0.0, 3.0), 2.0);
  EXPECT_EQ(LimitVelocity(kLimits, 0.0, -3.0), -2.0);
  EXPECT_EQ(LimitVelocity(kLimits, 1.6, 1.0), 0.0);
  EXPECT_EQ(LimitVelocity(kLimits, 1.6, -1.0), -1.0);
  EXPECT_EQ(LimitVelocity(kLimits, -1.1, -1.0), 0.0);
  EXPECT_EQ(LimitVelocity(kLimits, -1.1, 1.0), 1.0);
}

TEST(LimitPosition, ReachesTheCommandInStepsOfTheVelocityLimit) {
  constexpr double kPeriod_s = 0.01;  // 0.02 rad a step
  double last_rad = 0.0;
  int steps = 0;
  while (last_rad != 0.5 && steps < 100) {
    const PositionSetpoint next = LimitPosition(kLimits, last_rad, kPeriod_s, {0.5, 0.7});
    EXPECT_LE(std::abs(next.position_rad - last_rad), 0.02 + 1e-15);
    EXPECT_EQ(next.velocity_rad_s, next.position_rad == 0.5 ? 0.7 : 0.0)
        << "feed-forward only at the commanded position";
    last_rad = next.position_rad;
    ++steps;
  }
  EXPECT_NEAR(steps, 25, 1) << "0.5 rad of 0.02 each; the last may be a rounding";
}

TEST(LimitPosition, EndsAtAPositionLimitWithoutFeedForward) {
  const PositionSetpoint upper = LimitPosition(kLimits, 1.5, 0.01, {2.0, 0.7});
  EXPECT_EQ(upper.position_rad, 1.5);
  EXPECT_EQ(upper.velocity_rad_s, 0.0);
  const PositionSetpoint lower = LimitPosition(kLimits, -1.0, 0.01, {-2.0, -0.7});
  EXPECT_EQ(lower.position_rad, -1.0);
  EXPECT_EQ(lower.velocity_rad_s, 0.0);
  EXPECT_NEAR(LimitPosition(kLimits, 1.8, 0.01, {1.8, 0.0}).position_rad, 1.78, 1e-15)
      << "from outside it comes back at the velocity limit";
}

TEST(LimitPosition, FeedForwardIsWithinTheVelocityLimit) {
  EXPECT_EQ(LimitPosition(kLimits, 0.3, 0.01, {0.3, 9.0}).velocity_rad_s, 2.0);
  EXPECT_EQ(LimitPosition(kLimits, 0.3, 0.01, {0.3, -9.0}).velocity_rad_s, -2.0);
}

}  // namespace
}  // namespace sinew::bridge
