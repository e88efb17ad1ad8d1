// States, lost and faulty sensors, configuration of the fall detector.
#include "components/robot/fall/fall_detector.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>

#include "tests/components/robot/fall/fall_world.h"
#include "tests/support/allocations.h"

namespace sinew::fall {
namespace {

constexpr double kFallPeriod_s = 1.0 / 240.0;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr int kLostTicks = 12;  // 50 ms

// A robot that stands; a test spoils what its sensors send.
class Standing {
 public:
  explicit Standing(std::uint64_t seed = 1, const FallConfig& config = {})
      : detector(config, kFallPeriod_s), sensors(seed, config.tilt.imu) {
    for (int i = 0; i < 3 * 240; ++i) out = Step();
  }

  FallInput Next() {
    last = sensors.Read(tick, static_cast<double>(tick) * kFallPeriod_s, body);
    ++tick;
    return last;
  }
  FallOutput Step() { return detector.Step(Next()); }
  // Steps with spoilt inputs until the state is no longer upright; at most 10 s. Gives the ticks.
  int TicksUntilNotUpright(const std::function<void(FallInput*)>& spoil) {
    for (int i = 1; i <= 2400; ++i) {
      FallInput input = Next();
      spoil(&input);
      out = detector.Step(input);
      if (out.state != FallState::kUpright) return i;
    }
    return 0;
  }

  FallDetector detector;
  SensorModel sensors;
  BodyState body;
  FallInput last;
  FallOutput out;
  std::uint64_t tick = 0;
};

TEST(FallDetector, IsUnknownWithMotorsOffUntilItHasStartedAndThenUpright) {
  FallDetector detector(FallConfig{}, kFallPeriod_s);
  SensorModel sensors(3);
  FallOutput out;
  for (std::uint64_t tick = 0; tick < 240; ++tick) {
    out = detector.Step(sensors.Read(tick, 0.0, BodyState{}));
    ASSERT_EQ(out.state, FallState::kUnknown);
    ASSERT_EQ(out.unknown, Unknown::kStarting);
    ASSERT_TRUE(out.motors_off);
  }
  for (std::uint64_t tick = 240; tick < 720; ++tick) {
    out = detector.Step(sensors.Read(tick, 0.0, BodyState{}));
  }
  EXPECT_EQ(out.state, FallState::kUpright);
  EXPECT_EQ(out.unknown, Unknown::kNone);
  EXPECT_FALSE(out.motors_off);
  EXPECT_NEAR(out.height_share, 1.0, 0.02);
  EXPECT_NEAR(out.feet.total_N(), kMass_kg * types::kGravity_m_s2, 10.0);
}

TEST(FallDetector, StaysUpWithEverySensorForAnHourOfStandingStill) {
  for (std::uint64_t seed = 0; seed < 2; ++seed) {
    Standing robot(seed + 20);
    EXPECT_EQ(robot.TicksUntilNotUpright([](FallInput*) {}), 0);
    for (int i = 0; i < 3600 * 240; ++i) {
      robot.out = robot.Step();
      ASSERT_EQ(robot.out.state, FallState::kUpright)
          << i << " " << static_cast<int>(robot.out.criterion) << UnknownName(robot.out.unknown);
    }
    EXPECT_LT(robot.out.tilt_rad, robot.detector.filter().error_bound_rad());
  }
}

TEST(FallDetector, ReportsFallingWhenItIsStartedLyingDown) {
  FallDetector detector(FallConfig{}, kFallPeriod_s);
  SensorModel sensors(3);
  BodyState lying;
  lying.lean_rad = 80.0 * types::kDegree_rad;
  FallOutput out;
  for (std::uint64_t tick = 0; tick < 720; ++tick) {
    out = detector.Step(sensors.Read(tick, 0.0, lying));
    ASSERT_TRUE(out.motors_off);
  }
  EXPECT_EQ(out.state, FallState::kFalling);
  EXPECT_EQ(out.criterion, Criterion::kTilt);
}

TEST(FallDetector, FindsFreeFallWithFeetUnloadedBeforeThatWithoutThem) {
  Standing feet(4), no_feet(4);
  for (Standing* robot : {&feet, &no_feet}) {
    robot->body.vertical_m_s2 = -types::kGravity_m_s2;
    robot->body.load_share = 0.0;
  }
  const int with = feet.TicksUntilNotUpright([](FallInput*) {});
  const int without =
      no_feet.TicksUntilNotUpright([](FallInput* input) { input->feet.valid[2] = false; });
  EXPECT_EQ(feet.out.criterion, Criterion::kFreeFall);
  EXPECT_EQ(no_feet.out.criterion, Criterion::kFreeFall);
  EXPECT_EQ(with, 13);     // 12 periods of 4.17 ms are 50 ms
  EXPECT_EQ(without, 21);  // 20 are 83 ms
  EXPECT_LT(without * kFallPeriod_s, 0.1);
}

TEST(FallDetector, NamesTheTickInWhichTheCriterionFirstHeld) {
  Standing robot(5);
  robot.body.leg_m = 0.45;  // 0.69 of the reference
  const std::uint64_t first = robot.tick;
  const int ticks = robot.TicksUntilNotUpright([](FallInput*) {});
  EXPECT_EQ(robot.out.criterion, Criterion::kBaseHeight);
  EXPECT_EQ(robot.out.since_tick, first);
  EXPECT_EQ(ticks, 6);  // 5 periods of 4.17 ms are 21 ms
}

TEST(FallDetector, TakesOneCorruptPositionForNoFall) {
  Standing robot(5);
  for (int i = 0; i < 100; ++i) {
    FallInput input = robot.Next();
    if (i % 10 == 0) input.foot_to_base_m.z() = 0.1;
    ASSERT_EQ(robot.detector.Step(input).state, FallState::kUpright);
  }
}

TEST(FallDetector, ALowReferenceMakesALowBaseHealthy) {
  Standing robot(6);
  for (int i = 0; i < 240; ++i) {
    robot.body.leg_m = robot.body.reference_m = kStanding_m - 0.4 * i / 239.0;
    robot.body.leg_m *= 0.85;
    ASSERT_EQ(robot.Step().state, FallState::kUpright) << i;
  }
}

TEST(FallDetector, StaysFallingUntilReset) {
  Standing robot(7);
  robot.body.leg_m = 0.3;
  robot.TicksUntilNotUpright([](FallInput*) {});
  robot.body.leg_m = kStanding_m;
  for (int i = 0; i < 1000; ++i) robot.out = robot.Step();
  EXPECT_EQ(robot.out.state, FallState::kFalling);
  EXPECT_TRUE(robot.out.motors_off);
  robot.detector.Reset();
  EXPECT_EQ(robot.Step().unknown, Unknown::kStarting);
  for (int i = 0; i < 720; ++i) robot.out = robot.Step();
  EXPECT_EQ(robot.out.state, FallState::kUpright);
}

// Every loss ends in unknown after 50 ms, not before, and stays so.
TEST(FallDetector, IsUnknownAfterALossOfFiftyMilliseconds) {
  struct Loss {
    const char* name;
    Unknown unknown;
    std::function<void(FallInput*)> spoil;
  };
  FallInput frozen = Standing(8).Next();
  const Loss losses[] = {
      {"invalid IMU", Unknown::kImu, [](FallInput* input) { input->imu.valid = false; }},
      {"specific force is NaN", Unknown::kImu,
       [](FallInput* input) { input->imu.force_m_s2.y() = kNan; }},
      {"rate is infinite", Unknown::kImu,
       [](FallInput* input) { input->imu.rate_rad_s.x() = 1.0 / 0.0; }},
      {"saturated gyroscope", Unknown::kImu,
       [](FallInput* input) { input->imu.rate_rad_s.z() = -500.0 * types::kDegree_rad; }},
      {"frozen gyroscope", Unknown::kImu,
       [&frozen](FallInput* input) { input->imu.rate_rad_s = frozen.imu.rate_rad_s; }},
      {"frozen accelerometer", Unknown::kImu,
       [&frozen](FallInput* input) { input->imu.force_m_s2 = frozen.imu.force_m_s2; }},
      {"kinematics are NaN", Unknown::kKinematics,
       [](FallInput* input) { input->foot_to_base_m.z() = kNan; }},
      {"reference is NaN", Unknown::kReference,
       [](FallInput* input) { input->reference_height_m = kNan; }},
      {"reference is zero", Unknown::kReference,
       [](FallInput* input) { input->reference_height_m = 0.0; }},
      {"a whole foot", Unknown::kFeet,
       [](FallInput* input) {
         for (std::size_t i = 4; i < 8; ++i) input->feet.force_N[i] = kNan;
       }},
  };
  for (const Loss& loss : losses) {
    Standing robot(8);
    const std::uint64_t first = robot.tick;
    const int ticks = robot.TicksUntilNotUpright(loss.spoil);
    // One more where the first frozen sample is still new.
    EXPECT_GE(ticks, kLostTicks + 1) << loss.name;
    EXPECT_LE(ticks, kLostTicks + 2) << loss.name;
    EXPECT_EQ(robot.out.state, FallState::kUnknown) << loss.name;
    EXPECT_EQ(robot.out.unknown, loss.unknown) << loss.name;
    EXPECT_LE(robot.out.since_tick, first + 1) << loss.name;
    EXPECT_TRUE(robot.out.motors_off) << loss.name;
    for (int i = 0; i < 1000; ++i) robot.out = robot.Step();
    EXPECT_EQ(robot.out.state, FallState::kUnknown) << loss.name << " has gone";
  }
}

TEST(FallDetector, BridgesAShorterLoss) {
  Standing robot(9);
  for (int i = 0; i < 600; ++i) {
    FallInput input = robot.Next();
    if (i % 16 < kLostTicks) {
      input.imu.valid = false;
      input.foot_to_base_m.setConstant(kNan);
      input.reference_height_m = kNan;
      input.feet.valid.fill(false);
    }
    ASSERT_EQ(robot.detector.Step(input).state, FallState::kUpright) << i;
  }
}

TEST(FallDetector, BridgesMissingTicksUpToTheBoundOnly) {
  Standing robot(10);
  robot.tick += kLostTicks;
  EXPECT_EQ(robot.Step().state, FallState::kUpright);
  robot.tick += kLostTicks + 1;
  EXPECT_EQ(robot.Step().unknown, Unknown::kTicks);
}

TEST(FallDetector, LeavesOutAndCountsATickThatIsNotNew) {
  Standing robot(11);
  FallInput old = robot.last;
  old.foot_to_base_m.setZero();
  const FallOutput out = robot.detector.Step(old);
  EXPECT_EQ(out.state, FallState::kUpright);
  EXPECT_EQ(out.repeated_ticks, 1u);
}

// Impacts saturate a range of 2 g; that alone is no loss, but seconds of it are: without the
// specific force the tilt's error would pass its bound.
TEST(FallDetector, LivesWithASaturatedSpecificForceForAsLongAsTheGyroscopeSuffices) {
  Standing robot(12);
  const int ticks = robot.TicksUntilNotUpright(
      [](FallInput* input) { input->imu.force_m_s2.z() = 2.0 * types::kGravity_m_s2; });
  EXPECT_EQ(robot.out.unknown, Unknown::kSpecificForce);
  EXPECT_NEAR(ticks * kFallPeriod_s, robot.detector.filter().coast_s(), 2.0 * kFallPeriod_s);
  EXPECT_GT(robot.detector.filter().coast_s(), 1.0);
}

TEST(FallDetector, TakesAnyInputWithoutAnAlarmGoingUnnoticed) {
  Standing robot(13);
  const int ticks = robot.TicksUntilNotUpright([](FallInput* input) {
    input->imu.force_m_s2.setConstant(1e300);
    input->imu.rate_rad_s.setConstant(-1e300);
    input->foot_to_base_m.setConstant(1e300);
    input->reference_height_m = 1e-300;
    input->feet.force_N.fill(-1e300);
  });
  EXPECT_GT(ticks, 0);
  EXPECT_LE(ticks, kLostTicks + 1);
  EXPECT_TRUE(std::isfinite(robot.out.tilt_rad));
}

TEST(FallDetector, AllocatesNothingInAStep) {
  Standing robot(14);
  const FallInput input = robot.Next();
  const long before = test::Allocations();
  FallInput next = input;
  for (int i = 0; i < 100; ++i) {
    ++next.tick;
    robot.detector.Step(next);
  }
  robot.detector.Reset();
  EXPECT_EQ(test::Allocations(), before);
}

TEST(FallDetector, NamesCriteriaAndWhatIsUnknown) {
  EXPECT_EQ(UnknownName(Unknown::kSpecificForce), "specific_force");
}

TEST(FallDetector, RefusesFiguresOutOfRange) {
  FallConfig share, hold, lost, mass, coarse;
  share.height_share = 1.5;
  hold.free_fall_hold_s = 0.1;
  lost.lost_after_s = 0.001;
  mass.mass_kg = kNan;
  coarse.tilt.imu.force_bias_m_s2 = 3.0;
  for (const FallConfig& config : {share, hold, lost, mass, coarse}) {
    EXPECT_THROW(FallDetector(config, kFallPeriod_s), std::invalid_argument);
  }
}

TEST(Feet, AreSummedBySideAndSensorsThatAreLostAreLeftOut) {
  FootForces forces;
  for (std::size_t i = 0; i < 8; ++i) forces.force_N[i] = static_cast<double>(i + 1);
  forces.valid.fill(true);
  EXPECT_EQ(LoadsOf(forces).right_N, 10.0);
  EXPECT_EQ(LoadsOf(forces).left_N, 26.0);
  EXPECT_FALSE(LoadsOf(forces).right_carries_more());
  EXPECT_TRUE(LoadsOf(forces).complete());
  forces.valid[0] = false;
  forces.force_N[7] = kNan;
  EXPECT_EQ(LoadsOf(forces).right_N, 9.0);
  EXPECT_EQ(LoadsOf(forces).left_sensors, 3);
  EXPECT_FALSE(LoadsOf(forces).complete());
  EXPECT_FALSE(LoadsOf(forces).lost());
}

TEST(ImuCheck, KnowsNewSaturatedAndLostSamples) {
  ImuCheck check(ImuBounds{});
  ImuSample sample;
  EXPECT_FALSE(check.Step(sample).rate_usable);  // not valid
  sample.valid = true;
  sample.force_m_s2 = {0.0, 0.0, 9.8};
  EXPECT_TRUE(check.Step(sample).force_usable);
  EXPECT_FALSE(check.Step(sample).rate_usable);  // the same again
  sample.force_m_s2.z() = 32767.0 / 32768.0 * 2.0 * types::kGravity_m_s2;
  sample.rate_rad_s.x() = 0.1;
  EXPECT_TRUE(check.Step(sample).rate_usable);
  sample.force_m_s2.z() = -2.0 * types::kGravity_m_s2;
  sample.rate_rad_s.x() = 0.2;
  EXPECT_FALSE(check.Step(sample).force_usable);
}

}  // namespace
}  // namespace sinew::fall
