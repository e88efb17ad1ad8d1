// A standby's reference: its owner's until it is heard itself, and no step when it is.
#include "components/robot/reference/standby.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

namespace sinew::reference {
namespace {

constexpr double kCycle_s = 1.0 / 240.0;

RobotReferenceConfig SineJoint(const Limits& limits = {}) {
  RobotReferenceConfig config;
  GeneratorConfig joint;
  joint.trajectory = std::make_shared<Sine>(SineConfig{.amplitude_rad = 0.5, .frequency_Hz = 0.4});
  joint.soft_start_s = 2.0;
  joint.limits = limits;
  config.joints.push_back(joint);
  return config;
}

struct StandbyRig {
  explicit StandbyRig(const RobotReferenceConfig& config = SineJoint()) : standby(config) {}

  RobotReferenceInput At(std::uint64_t tick) {
    RobotReferenceInput input;
    input.session_id = 5;
    input.tick = tick;
    input.period_s = kCycle_s;
    input.may_move = true;
    input.joint_count = 1;
    input.position_rad = measured_rad;
    input.valid = valid;
    return input;
  }
  static RobotReferenceOutput Asking(const Point& point, bool idle = false) {
    RobotReferenceOutput owner;
    owner.joint_count = 1;
    owner.idle = idle;
    owner.joint[0] = point;
    return owner;
  }

  std::array<double, 1> measured_rad{0.1};
  std::array<bool, 1> valid{true};
  Standby standby;
};

TEST(StandbyReference, CarriesTheOwnersLateReferenceOnToThePresentTick) {
  StandbyRig rig;
  rig.standby.Follow(10, StandbyRig::Asking({0.3, 1.2, -2.0}));
  const RobotReferenceOutput now = rig.standby.Step(rig.At(12), true);
  const double t = 2.0 * kCycle_s;
  EXPECT_FALSE(now.idle);
  EXPECT_NEAR(now.joint[0].position_rad, 0.3 + 1.2 * t - t * t, 1e-15);
  EXPECT_NEAR(now.joint[0].velocity_rad_s, 1.2 - 2.0 * t, 1e-15);
  EXPECT_EQ(now.joint[0].acceleration_rad_s2, -2.0);
}

// The owner has ended while this one was stopped.
TEST(StandbyReference, AsksForNothingWhereTheOwnersPointsAreOld) {
  StandbyRig rig;
  rig.standby.Follow(10, StandbyRig::Asking({0.3, 1.2, -2.0}));
  EXPECT_FALSE(rig.standby.Step(rig.At(58), true).idle) << "0.2 s";
  EXPECT_TRUE(rig.standby.Step(rig.At(400), true).idle);
  for (std::uint64_t tick = 401; tick < 401 + 4 * 240; ++tick) {
    EXPECT_TRUE(rig.standby.Step(rig.At(tick), false).idle) << tick;
  }
  RobotReferenceInput disarmed = rig.At(1400);
  disarmed.may_move = false;
  (void)rig.standby.Step(disarmed, false);
  EXPECT_FALSE(rig.standby.Step(rig.At(1401 + 240), false).idle) << "armed anew";
}

TEST(StandbyReference, GoesOnWithoutAStepFromWhatMovesAndReachesItsOwnTrajectory) {
  for (const double velocity_rad_s : {1.25, -1.25, 0.02}) {
    StandbyRig rig;
    const Point last{0.3, velocity_rad_s, -3.0};
    rig.standby.Follow(99, StandbyRig::Asking(last));
    Point before = rig.standby.Step(rig.At(99), true).joint[0];
    for (std::uint64_t tick = 100; tick < 100 + 4 * 240; ++tick) {
      const Point now = rig.standby.Step(rig.At(tick), false).joint[0];
      // Position and velocity are the integrals of velocity and acceleration.
      EXPECT_NEAR(now.position_rad - before.position_rad,
                  0.5 * kCycle_s * (now.velocity_rad_s + before.velocity_rad_s), 2e-5)
          << tick;
      EXPECT_NEAR(now.velocity_rad_s - before.velocity_rad_s,
                  0.5 * kCycle_s * (now.acceleration_rad_s2 + before.acceleration_rad_s2), 3e-3)
          << tick;
      before = now;
    }
    const double time_s = (4.0 * 240.0 - 1.0) * kCycle_s - 2.0;  // past the soft start
    EXPECT_NEAR(before.position_rad, 0.5 * std::sin(2.0 * M_PI * 0.4 * time_s), 1e-9);
  }
}

TEST(StandbyReference, StopsBeforeAPositionLimitThatIsInItsWay) {
  StandbyRig rig(SineJoint({.position_lower_rad = -0.6, .position_upper_rad = 0.6}));
  rig.standby.Follow(9, StandbyRig::Asking({0.58, 1.25, 0.0}));
  (void)rig.standby.Step(rig.At(9), true);
  double highest_rad = 0.0;
  for (std::uint64_t tick = 10; tick < 10 + 480; ++tick) {
    highest_rad =
        std::max(highest_rad, rig.standby.Step(rig.At(tick), false).joint[0].position_rad);
  }
  EXPECT_GT(highest_rad, 0.58);
  EXPECT_LE(highest_rad,
            0.6 + 1e-3);  // the owner's last point, carried on by one tick, may be in it
}

TEST(StandbyReference, HoldsWhatIsAtRestUntilTheOperatorSaysStart) {
  StandbyRig rig;
  rig.standby.Follow(9, StandbyRig::Asking({0.3, 0.0, 0.0}));
  (void)rig.standby.Step(rig.At(9), true);
  for (std::uint64_t tick = 10; tick < 2000; ++tick) {
    const RobotReferenceOutput now = rig.standby.Step(rig.At(tick), false);
    ASSERT_FALSE(now.idle);
    ASSERT_EQ(now.joint[0].position_rad, 0.3);
    ASSERT_EQ(now.joint[0].velocity_rad_s, 0.0);
  }
  RobotReferenceInput start = rig.At(2000);
  start.operator_start = true;
  EXPECT_EQ(rig.standby.Step(start, false).joint[0].position_rad, 0.3);
  EXPECT_NE(rig.standby.Step(rig.At(2240), false).joint[0].position_rad, 0.3);
}

TEST(StandbyReference, AnIdleOwnersSuccessorMovesOnlyWhenTheRobotIsArmedAnew) {
  StandbyRig rig;
  rig.standby.Follow(9, StandbyRig::Asking({0.1, 0.0, 0.0}, true));
  (void)rig.standby.Step(rig.At(9), true);
  for (std::uint64_t tick = 10; tick < 2000; ++tick) {
    ASSERT_TRUE(rig.standby.Step(rig.At(tick), false).idle) << tick;
  }
  RobotReferenceInput disarmed = rig.At(2000);
  disarmed.may_move = false;
  EXPECT_TRUE(rig.standby.Step(disarmed, false).idle);
  EXPECT_FALSE(rig.standby.Step(rig.At(2001), false).idle);
}

TEST(StandbyReference, OnARobotThatMayNotMoveItIsIdleAfterTakingOver) {
  StandbyRig rig;
  rig.standby.Follow(9, StandbyRig::Asking({0.3, 1.0, 0.0}));
  (void)rig.standby.Step(rig.At(9), true);
  RobotReferenceInput disarmed = rig.At(10);
  disarmed.may_move = false;
  EXPECT_TRUE(rig.standby.Step(disarmed, false).idle);
}

TEST(StandbyReference, WithoutAnOwnerItIsItsOwn) {
  StandbyRig rig;
  RobotReference own(SineJoint());
  for (std::uint64_t tick = 0; tick < 1000; ++tick) {
    ASSERT_EQ(rig.standby.Step(rig.At(tick), false).joint[0].position_rad,
              own.Step(rig.At(tick)).joint[0].position_rad);
  }
}

}  // namespace
}  // namespace sinew::reference
