// Falls and healthy squats through a provider's cycle, from sensors and commands to what the joints
// do.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "tests/components/robot/provider/guarded_biped.h"
#include "tests/support/allocations.h"

namespace sinew::provider {
namespace {

using ::testing::HasSubstr;
using types::ControlMode;
using types::RobotState;

constexpr int kSquatSeeds = 20;
constexpr double kLate_s = 0.05;    // of the base behind what is asked
constexpr double kFolded_m = 0.27;  // of the base above the ground, with a leg that can still bend

using Now = GuardedBiped::Now;

// Squatting: asked and, kLate_s later, done.
Now Squatting(double since_s, ControlMode mode = ControlMode::kPosition) {
  Now now;
  now.asked_m = SquatHeight_m(since_s);
  now.body.leg_m = SquatHeight_m(since_s - kLate_s);
  now.body.vertical_m_s2 =
      -kAmplitude_m * kSquat_rad_s * kSquat_rad_s * std::cos(kSquat_rad_s * (since_s - kLate_s));
  now.body.leg_vertical = true;
  now.mode = mode;
  return now;
}

// Leans from since_s = 0 on with 60 degrees a second: 30 degrees after half a second.
constexpr double kLean_rad_s = 60.0 * types::kDegree_rad;
constexpr double kFallen_s = 0.5;
Now Leaning(double since_s) {
  Now now;
  now.body.leg_m = kHighest_m;
  now.body.lean_rad_s = kLean_rad_s;
  now.body.lean_rad = kLean_rad_s * since_s;
  return now;
}

bool AllIdle(const PlantCommand& command) {
  return std::all_of(command.mode.begin(), command.mode.end(),
                     [](ControlMode mode) { return mode == ControlMode::kIdle; });
}

TEST(FallGuard, HealthySquatsRaiseNoAlarmWhateverTheModeOfTheCommands) {
  for (int seed = 0; seed < kSquatSeeds; ++seed) {
    GuardedBiped biped({}, static_cast<std::uint64_t>(seed) + 100);
    biped.StandAndArm();
    const ControlMode mode = seed % 2 == 0 ? ControlMode::kPosition : ControlMode::kTorque;
    const auto fault_s =
        biped.FaultAfter_s(10.0, [&](double since_s) { return Squatting(since_s, mode); });
    EXPECT_FALSE(fault_s) << "seed " << seed << " at " << *fault_s
                          << " s: " << biped.cycle().fall_message();
    EXPECT_TRUE(biped.cycle().upright());
  }
}

TEST(FallGuard, ALeanBeyondThirtyDegreesIsAFaultWithin100msAndTheJointsIdle) {
  for (int seed = 0; seed < kSquatSeeds; ++seed) {
    GuardedBiped biped({}, static_cast<std::uint64_t>(seed) + 200);
    biped.StandAndArm();
    const auto fault_s = biped.FaultAfter_s(2.0, &Leaning);
    ASSERT_TRUE(fault_s) << seed;
    EXPECT_LE(*fault_s, kFallen_s + kDetection_s) << seed;
    EXPECT_EQ(biped.change(), FaultChange::kRobot);
    EXPECT_THAT(std::string(biped.cycle().fall_message()), HasSubstr("fall: tilt ")) << seed;
    EXPECT_FALSE(AllIdle(biped.command())) << "of the step in which it was found";
    biped.Step(Leaning(*fault_s + kBipedPeriod_s));
    EXPECT_TRUE(AllIdle(biped.command()));
  }
}

TEST(FallGuard, WithThePolicyDampTheJointsOfARobotThatFallsAreDamped) {
  GuardConfig guard;
  guard.on_fall = FallPolicy::kDamp;
  guard.damping_Nm_s_rad = 1e-3;
  GuardedBiped biped(guard);
  biped.StandAndArm();
  const auto fault_s = biped.FaultAfter_s(2.0, &Leaning);
  ASSERT_TRUE(fault_s);
  for (int i = 0; i < 100; ++i) biped.Step(Leaning(*fault_s));
  EXPECT_EQ(biped.cycle().state(), RobotState::kFault);
  EXPECT_EQ(biped.command().mode[3], ControlMode::kTorque);
  EXPECT_EQ(biped.command().motor_torque_Nm[3], 0.0) << "no motor turns, so nothing is damped";
}

TEST(FallGuard, ABaseThatSinksBelowWhatIsAskedIsAFaultAlsoInASquat) {
  for (const double begin_s : {0.0, 1.0, 2.5, 4.0}) {
    GuardedBiped biped({});
    biped.StandAndArm();
    ASSERT_FALSE(biped.FaultAfter_s(begin_s, [](double s) { return Squatting(s); }));
    // From here on the base sinks with 0.3 m/s more than is asked.
    double low_s = -1.0;
    const auto fault_s = biped.FaultAfter_s(2.0, [&](double since_s) {
      Now now = Squatting(begin_s + since_s);
      now.body.leg_m = std::max(kFolded_m, now.body.leg_m - 0.3 * since_s);
      if (low_s < 0.0 && now.body.leg_m < 0.8 * now.asked_m) low_s = since_s;
      return now;
    });
    ASSERT_TRUE(fault_s) << begin_s;
    ASSERT_GE(low_s, 0.0) << begin_s;
    EXPECT_LE(*fault_s, low_s + kDetection_s) << begin_s;
    EXPECT_THAT(std::string(biped.cycle().fall_message()), HasSubstr("fall: base_height "));
  }
}

// A controller with a fault of its own idles the joints of an armed robot: nobody asks the base to
// sink.
TEST(FallGuard, LegsThatFoldBecauseTheyIdleAreAFall) {
  GuardedBiped biped({});
  biped.StandAndArm();
  biped.Step({});
  const auto fault_s = biped.FaultAfter_s(2.0, [](double since_s) {
    Now now;
    now.mode = ControlMode::kIdle;
    now.body.leg_m = std::max(kFolded_m, kHighest_m - 0.3 * since_s);
    now.asked_m = now.body.leg_m;  // an idle joint's position is no order
    return now;
  });
  ASSERT_TRUE(fault_s);
  EXPECT_THAT(std::string(biped.cycle().fall_message()), HasSubstr("base_height"));
}

struct Loss {
  const char* name;
  void (*lose)(Now*);
};

TEST(FallGuard, LostSensorsAreAFaultWithin100ms) {
  const Loss losses[] = {{"imu", [](Now* now) { now->imu_valid = false; }},
                         {"feet", [](Now* now) { now->feet_valid = false; }},
                         {"kinematics", [](Now* now) { now->encoders_valid = false; }}};
  for (const Loss& loss : losses) {
    GuardedBiped biped({});
    biped.StandAndArm();
    const auto fault_s = biped.FaultAfter_s(1.0, [&](double since_s) {
      Now now = Squatting(since_s);
      loss.lose(&now);
      return now;
    });
    ASSERT_TRUE(fault_s) << loss.name;
    EXPECT_LE(*fault_s, kDetection_s) << loss.name;
    EXPECT_THAT(std::string(biped.cycle().fall_message()),
                HasSubstr(std::string("lost: ") + loss.name));
    biped.Step(Squatting(*fault_s));
    EXPECT_TRUE(AllIdle(biped.command())) << loss.name;
  }
}

TEST(FallGuard, ABriefLossIsNone) {
  GuardedBiped biped({});
  biped.StandAndArm();
  EXPECT_FALSE(biped.FaultAfter_s(5.0, [](double since_s) {
    Now now = Squatting(since_s);
    now.imu_valid = std::fmod(since_s, 1.0) > 0.04;
    return now;
  })) << biped.cycle().fall_message();
}

TEST(FallGuard, AFallStaysUntilTheResetAndThenTheDetectorStartsAnew) {
  GuardedBiped biped({});
  biped.StandAndArm();
  ASSERT_TRUE(biped.FaultAfter_s(2.0, &Leaning));
  for (int i = 0; i < 1000; ++i) biped.Step({});
  EXPECT_EQ(biped.cycle().state(), RobotState::kFault) << "upright again, but nobody has reset it";
  EXPECT_NE(biped.Arm(), OperatorResult::kDone);
  EXPECT_EQ(biped.Reset(), OperatorResult::kClearFaults);
  EXPECT_EQ(biped.cycle().state(), RobotState::kDisarmed);
  EXPECT_EQ(biped.cycle().fall_message(), "");
  biped.Step({});
  EXPECT_EQ(biped.Arm(), OperatorResult::kRefusedByFallGuard);
  EXPECT_THAT(biped.cycle().FallRefusal(), HasSubstr("has not started"));
  const double reset_s = biped.time_s();
  while (biped.time_s() < reset_s + kStarted_s) biped.Step({});
  EXPECT_EQ(biped.Arm(), OperatorResult::kDone);
}

TEST(FallGuard, BeforeTheDetectorHasStartedNobodyArms) {
  GuardedBiped biped({});
  EXPECT_EQ(biped.Arm(), OperatorResult::kRefusedByFallGuard);
  while (biped.time_s() < 1.9) biped.Step({});
  EXPECT_EQ(biped.Arm(), OperatorResult::kRefusedByFallGuard) << "it takes 2 s";
  while (biped.time_s() < kStarted_s) biped.Step({});
  EXPECT_EQ(biped.Arm(), OperatorResult::kDone);
}

// A simulation that is armed from its first tick on: its detector starts meanwhile, or it is
// stopped.
TEST(FallGuard, ArmedFromTheFirstTickOnTheDetectorMustStartInTime) {
  GuardedBiped stands({});
  stands.cycle().ArmAtStart();
  EXPECT_FALSE(stands.FaultAfter_s(12.0, [](double) { return Now{}; }));
  EXPECT_TRUE(stands.cycle().upright());

  GuardedBiped blind({});
  blind.cycle().ArmAtStart();
  const auto fault_s = blind.FaultAfter_s(12.0, [](double) {
    Now now;
    now.imu_valid = false;
    return now;
  });
  ASSERT_TRUE(fault_s);
  EXPECT_NEAR(*fault_s, 10.0, 2.0 * kBipedPeriod_s);
  EXPECT_THAT(std::string(blind.cycle().fall_message()), HasSubstr("has not started within 10 s"));
}

TEST(FallGuard, OfARobotThatMayNotMoveNobodyAsksForAHeight) {
  GuardedBiped biped({});
  while (biped.time_s() < kStarted_s) biped.Step({});
  // Somebody lets the robot down: the base is far below what was ever asked.
  EXPECT_FALSE(biped.FaultAfter_s(3.0, [](double since_s) {
    Now now;
    now.body.leg_m = std::max(kFolded_m, kHighest_m - 0.2 * since_s);
    now.body.leg_vertical = true;
    now.commands = false;
    return now;
  })) << biped.cycle().fall_message();
  EXPECT_TRUE(biped.FaultAfter_s(2.0, &Leaning)) << "a fall is one whoever has armed it";
}

// Armed in a squat; no command comes, and the provider damps. What it damps is no order to stand
// with straight legs (positions of 0).
TEST(FallGuard, DampingBeforeTheFirstCommandAsksForNothing) {
  GuardConfig guard;
  guard.fault_after = std::chrono::milliseconds(10000);
  GuardedBiped biped(guard);
  Now low;
  low.body.leg_m = low.asked_m = 0.4;
  low.body.leg_vertical = true;
  low.commands = false;
  while (biped.time_s() < kStarted_s) biped.Step(low);
  ASSERT_EQ(biped.Arm(), OperatorResult::kDone);
  EXPECT_FALSE(biped.FaultAfter_s(3.0, [&](double) { return low; }))
      << biped.cycle().fall_message();
  EXPECT_EQ(biped.cycle().state(), RobotState::kDamped);
}

TEST(FallGuard, AHoldAsksForWhatItHolds) {
  GuardConfig guard;
  guard.bridging = Bridging::kHold;
  guard.fault_after = std::chrono::milliseconds(10000);
  GuardedBiped biped(guard);
  biped.StandAndArm();
  ASSERT_FALSE(biped.FaultAfter_s(1.2, [](double s) { return Squatting(s); }));
  Now held = Squatting(1.2);
  held.commands = false;
  EXPECT_FALSE(biped.FaultAfter_s(2.0, [&](double) { return held; }))
      << biped.cycle().fall_message();
  EXPECT_EQ(biped.cycle().state(), RobotState::kDamped);
}

TEST(FallGuard, TheReferenceIsTheHeightAboveTheSoleWhateverLegCarries) {
  FallGuardConfig config = BipedFallGuard();
  for (const double height_m : {0.3, 0.5, 0.7}) {
    for (const bool right : {false, true}) {
      FallGuard guard(config, kBipedPeriod_s);
      PlantSensors sensors;
      sensors.position_rad = SquatAngles(height_m);
      sensors.valid.fill(true);
      PlantCommand asked;
      asked.mode.fill(ControlMode::kTorque);
      asked.position_rad = SquatAngles(height_m - 0.02);
      BodySensors body;
      body.foot_valid.fill(true);
      body.foot_force_N[right ? 1 : 6] = 100.0;
      // The other leg is asked for something else.
      asked.position_rad[right ? leg::kKnee : leg::kLegJoints + leg::kKnee] += 0.5;
      (void)guard.Step(0, sensors, body, RobotState::kArmed, &asked);
      EXPECT_NEAR(guard.reference_height_m(), height_m - 0.02, 1e-12) << height_m << ' ' << right;
      EXPECT_NEAR(guard.output().base_height_m, 0.0, 1e-12) << "not before the filter has started";
    }
  }
}

TEST(FallGuard, NeitherHealthyNorFallingAnythingIsAllocated) {
  GuardedBiped biped({});
  biped.StandAndArm();
  const long before = test::Allocations();
  (void)biped.FaultAfter_s(5.0, [](double s) { return Squatting(s); });
  const auto fault_s = biped.FaultAfter_s(2.0, &Leaning);
  EXPECT_EQ(test::Allocations(), before);
  EXPECT_TRUE(fault_s);
}

TEST(FallGuard, WhatDoesNotFitIsRefused) {
  const auto refused = [](const auto& change) {
    FallGuardConfig config = BipedFallGuard();
    change(&config);
    EXPECT_THROW(FallGuard(config, kBipedPeriod_s), std::invalid_argument);
  };
  refused([](FallGuardConfig* c) { c->left.joint[2] = types::kMaxJoints; });
  refused([](FallGuardConfig* c) { c->right.joint[2] = -1; });
  refused([](FallGuardConfig* c) { c->joint_count = 6; });
  refused([](FallGuardConfig* c) { c->start_within_s = 0.0; });
  refused([](FallGuardConfig* c) { c->start_within_s = std::numeric_limits<double>::quiet_NaN(); });
  refused([](FallGuardConfig* c) { c->imu_from_base(0, 0) = -1.0; });
  refused([](FallGuardConfig* c) { c->imu_from_base *= 1.1; });
  refused([](FallGuardConfig* c) { c->detector.mass_kg = 0.0; });
  EXPECT_THROW(FallGuard(BipedFallGuard(), 0.1), std::invalid_argument) << "no tick in 100 ms";

  CycleConfig config{.joint_count = 2};
  config.guard.fall = std::make_shared<const FallGuardConfig>(BipedFallGuard());
  EXPECT_THROW(ProviderCycle{config}, std::invalid_argument);
}

TEST(FallGuard, WhatIsNotANumberIsALossAndNeverAnAsk) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  FallGuard guard(BipedFallGuard(), kBipedPeriod_s);
  PlantSensors sensors;
  sensors.position_rad.fill(nan);
  sensors.valid.fill(true);
  BodySensors body;
  body.imu_valid = true;
  body.acceleration_m_s2.fill(nan);
  body.foot_force_N.fill(nan);
  body.foot_valid.fill(true);
  for (std::uint64_t tick = 0; tick < 2000; ++tick) {
    (void)guard.Step(tick, sensors, body, RobotState::kDisarmed, nullptr);
  }
  EXPECT_FALSE(guard.upright());
  EXPECT_FALSE(guard.fallen()) << "it has never started, and the robot may not move";
  EXPECT_NE(guard.ArmRefusal(), "");
}

}  // namespace
}  // namespace sinew::provider
