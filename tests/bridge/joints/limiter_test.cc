// Limits against their law, on both sides of every bound.
#include "bridge/joints/limiter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace sinew::bridge {
namespace {

constexpr double kTorqueConstant_Nm_A = 0.02;
constexpr double kPeriod_s = 0.01;
// Torque 0.4 Nm, current 10 A (0.2 Nm), 2 rad/s, -1 to 1.5 rad.
const JointLimits kLimits{0.4, 10.0, 2.0, -1.0, 1.5, 0.2, 90.0};

JointConfig JointWith(const JointLimits& limits) {
  JointConfig joint;
  joint.limits = limits;
  joint.gear_ratio = 100.0;
  joint.torque_constant_Nm_A = kTorqueConstant_Nm_A;
  return joint;
}

// The inertia is not declared; v_limit^2 / (2 margin) = 10 rad/s^2.
double TorqueOf(const JointLimits& limits, const MeasuredMotion& measured, double torque_Nm) {
  return LimitTorque(limits, EnvelopeOf(JointWith(limits), kPeriod_s),
                     RangeFrom(limits, limits.lower_rad), measured, torque_Nm);
}

double Torque(const MeasuredMotion& measured, double torque_Nm) {
  return TorqueOf(kLimits, measured, torque_Nm);
}

double Velocity(const MeasuredMotion& measured, double velocity_rad_s) {
  return LimitVelocity(kLimits, EnvelopeOf(JointWith(kLimits), kPeriod_s), measured,
                       velocity_rad_s);
}

PositionSetpoint Position(double last_rad, const PositionSetpoint& command) {
  return LimitPosition(kLimits, EnvelopeOf(JointWith(kLimits), kPeriod_s), last_rad, kPeriod_s,
                       command);
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
  EXPECT_EQ(TorqueOf(weak, {0.0, 0.0}, 0.3), 0.05) << "the torque's";
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
  EXPECT_EQ(Torque({0.0, 1.49}, 0.1), 0.1) << "at rest within them";
  EXPECT_EQ(Torque({0.0, -0.99}, -0.1), -0.1);
}

TEST(LimitTorque, IsTakenAwayAlongTheEnvelopeWhereTheInertiaIsNotDeclared) {
  // 0.1 rad before the limit less 15 ms of 1 rad/s: sqrt(2 10 0.085) = 1.304 rad/s.
  EXPECT_EQ(Torque({1.0, 1.4}, 0.1), 0.1) << "slower than that less its taper";
  EXPECT_EQ(Torque({1.5, 1.4}, 0.1), 0.0) << "faster";
  EXPECT_EQ(Torque({1.5, 1.4}, 0.0), 0.0) << "but it is not braked: how hard is not known";
  EXPECT_EQ(Torque({1.5, 1.4}, -0.1), -0.1);
  EXPECT_EQ(Torque({1.5, 0.0}, 0.1), 0.1) << "far from the limit";
  JointLimits sharp = kLimits;
  sharp.margin_rad = 0.0;
  EXPECT_EQ(TorqueOf(sharp, {1.5, 1.4}, 0.1), 0.1) << "no margin, no envelope";
}

// For any input: no larger than commanded, never of the other sign, mirrored when all is mirrored.
TEST(LimitTorque, NeverAddsAndIsSymmetric) {
  const JointLimits symmetric{0.4, 10.0, 2.0, -1.5, 1.5, 0.2, 90.0};
  std::mt19937 random(3);
  std::uniform_real_distribution<double> torque(-0.6, 0.6), velocity(-3.0, 3.0), angle(-2.0, 2.0);
  for (int i = 0; i < 10'000; ++i) {
    const double commanded_Nm = torque(random);
    const MeasuredMotion measured{velocity(random), angle(random)};
    const double limited_Nm = TorqueOf(symmetric, measured, commanded_Nm);
    ASSERT_LE(std::abs(limited_Nm), std::min(std::abs(commanded_Nm), 0.2));
    ASSERT_GE(limited_Nm * commanded_Nm, 0.0);
    ASSERT_EQ(
        TorqueOf(symmetric, {-measured.velocity_rad_s, -measured.position_rad}, -commanded_Nm),
        -limited_Nm);
  }
}

TEST(LimitVelocity, ClampsAndStopsOutwardsBeyondAPositionLimit) {
  EXPECT_EQ(Velocity({0.0, 0.0}, 1.0), 1.0);
  EXPECT_EQ(Velocity({0.0, 0.0}, 3.0), 2.0);
  EXPECT_EQ(Velocity({0.0, 0.0}, -3.0), -2.0);
  EXPECT_EQ(Velocity({0.0, 1.6}, 1.0), 0.0);
  EXPECT_EQ(Velocity({0.0, 1.6}, -1.0), -1.0);
  EXPECT_EQ(Velocity({0.0, -1.1}, -1.0), 0.0);
  EXPECT_EQ(Velocity({0.0, -1.1}, 1.0), 1.0);
}

TEST(LimitVelocity, FollowsTheEnvelopeTowardsAPositionLimit) {
  // 0.1 rad before the limit, at 1 rad/s for 15 ms: sqrt(2 10 0.085).
  EXPECT_NEAR(Velocity({1.0, 1.4}, 2.0), std::sqrt(1.7), 1e-12);
  EXPECT_NEAR(Velocity({-1.0, -0.9}, -2.0), -std::sqrt(1.7), 1e-12);
  EXPECT_EQ(Velocity({1.0, 1.4}, -2.0), -2.0) << "away from it";
}

TEST(LimitPosition, ReachesTheCommandInStepsOfTheVelocityLimit) {
  // 0.02 rad a step
  double last_rad = 0.0;
  int steps = 0;
  while (last_rad != 0.5 && steps < 100) {
    const PositionSetpoint next = Position(last_rad, {0.5, 0.7});
    EXPECT_LE(std::abs(next.position_rad - last_rad), 0.02 + 1e-15);
    EXPECT_EQ(next.velocity_rad_s, next.position_rad == 0.5 ? 0.7 : 0.0)
        << "feed-forward only at the commanded position";
    last_rad = next.position_rad;
    ++steps;
  }
  EXPECT_NEAR(steps, 25, 1) << "0.5 rad of 0.02 each; the last may be a rounding";
}

TEST(LimitPosition, EndsAtAPositionLimitWithoutFeedForward) {
  const PositionSetpoint upper = Position(1.5, {2.0, 0.7});
  EXPECT_EQ(upper.position_rad, 1.5);
  EXPECT_EQ(upper.velocity_rad_s, 0.0);
  const PositionSetpoint lower = Position(-1.0, {-2.0, -0.7});
  EXPECT_EQ(lower.position_rad, -1.0);
  EXPECT_EQ(lower.velocity_rad_s, 0.0);
  EXPECT_NEAR(Position(1.8, {1.8, 0.0}).position_rad, 1.78, 1e-15)
      << "from outside it comes back at the velocity limit";
}

TEST(LimitPosition, TheSetpointSlowsDownBeforeAPositionLimit) {
  double last_rad = 1.0;
  double before_rad_s = 2.0;
  for (int i = 0; i < 200; ++i) {
    const double next_rad = Position(last_rad, {9.0, 0.0}).position_rad;
    const double rad_s = (next_rad - last_rad) / kPeriod_s;
    ASSERT_LE(rad_s, std::sqrt(2.0 * 10.0 * (1.5 - last_rad)) + 1e-9);
    // sqrt falls by a P a step, and by twice that in the last one, where it meets the limit.
    ASSERT_GE(rad_s, before_rad_s - 2.0 * 10.0 * kPeriod_s - 1e-9);
    before_rad_s = rad_s;
    last_rad = next_rad;
  }
  EXPECT_EQ(last_rad, 1.5);
}

TEST(LimitPosition, FeedForwardIsWithinTheVelocityLimit) {
  EXPECT_EQ(Position(0.3, {0.3, 9.0}).velocity_rad_s, 2.0);
  EXPECT_EQ(Position(0.3, {0.3, -9.0}).velocity_rad_s, -2.0);
}

}  // namespace
}  // namespace sinew::bridge
