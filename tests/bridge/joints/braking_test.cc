// The braking envelope: its law in numbers, and a joint that nothing moves beyond its limit.
#include "bridge/joints/braking.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <random>

#include "bridge/joints/limiter.h"

namespace sinew::bridge {
namespace {

constexpr double kRigPeriod_s = 1.0 / 240.0;

// The rig: robots/rig/can_bridge.yaml.
JointConfig BrakedJoint() {
  JointConfig joint;
  joint.name = "joint";
  joint.gear_ratio = 100.0;
  joint.torque_constant_Nm_A = 0.0159155;
  joint.torque_efficiency = 0.77;
  joint.limits = {0.398, 25.0, 8.0, -1.9, 1.9, 0.2, 90.0};
  joint.limits.braking = Braking{0.115, 0.35, 8.0};
  return joint;
}

TEST(Braking, DecelerationIsWhatTheMotorHasLeftForTheWorstInertia) {
  // 25 A times the torque constant is less than 0.398 Nm.
  EXPECT_NEAR(BrakingDeceleration(BrakedJoint()), (77.0 * 0.3978875 - 8.0) / 0.35, 1e-9);
}

TEST(Braking, AnEnvelopeStopsAtTheLimitWithNoMoreThanItsDeceleration) {
  const Envelope e = EnvelopeOf(BrakedJoint(), kRigPeriod_s);
  EXPECT_EQ(EnvelopeVelocity(e, 0.0), 0.0);
  double last_rad_s = 0.0;
  constexpr double kStep_rad = 1e-4;
  for (double d = kStep_rad; d < 2.0; d += kStep_rad) {
    const double v = EnvelopeVelocity(e, d);
    ASSERT_GT(v, last_rad_s);
    ASSERT_LE(v, std::sqrt(2.0 * e.deceleration_rad_s2 * d) * (1.0 + 1e-12));
    // v dv/dd, at the middle of the step.
    const double a = 0.5 * (v + last_rad_s) * (v - last_rad_s) / kStep_rad;
    ASSERT_LE(a, e.deceleration_rad_s2 * (1.0 + 1e-6)) << "at " << d;
    last_rad_s = v;
  }
}

TEST(Braking, TheLoopOfLatencyAndLightestInertiaIsStableForAnyRatioOfInertias) {
  for (const double ratio : {1.0, 2.0, 5.0, 20.0, 100.0}) {
    JointConfig joint = BrakedJoint();
    joint.limits.braking->max_inertia_kg_m2 = 0.115 * ratio;
    const Envelope e = EnvelopeOf(joint, kRigPeriod_s);
    const double slope =
        e.gain_Nm_s_rad + 100.0 * e.motor_torque_Nm * e.approach_1_s / e.deceleration_rad_s2;
    EXPECT_LE(slope * e.latency_s / 0.115, 1.4 + 1e-12);
  }
}

TEST(Braking, AtRestAtTheLimitNothingIsAllowedOutwardsAndBeyondItPushesBack) {
  const Envelope e = EnvelopeOf(BrakedJoint(), kRigPeriod_s);
  EXPECT_EQ(LargestTorque(e, 0.0, 0.0), 0.0);
  EXPECT_LT(LargestTorque(e, -0.01, 0.0), 0.0);
  EXPECT_GT(LargestTorque(e, 0.01, 0.0), 0.0);
  EXPECT_EQ(LargestTorque(e, 1.5, 0.0), e.motor_torque_Nm) << "far away the motor's limit";
  EXPECT_EQ(LargestTorque(e, 0.1, 8.0), -e.motor_torque_Nm) << "too fast: all the motor has";
}

TEST(Braking, AJointArmedOutsideIsNotThrownBackButMayNotGoFurther) {
  const JointConfig joint = BrakedJoint();
  const Envelope e = EnvelopeOf(joint, kRigPeriod_s);
  const auto torque = [&](const PositionRange& range, double position_rad, double commanded_Nm) {
    return LimitTorque(joint.limits, e, range, {0.0, position_rad}, commanded_Nm);
  };
  PositionRange range = RangeFrom(joint.limits, 2.0);
  EXPECT_EQ(torque(range, 2.0, 0.0), 0.0) << "it stays";
  EXPECT_EQ(torque(range, 2.0, 0.3), 0.0) << "no further";
  EXPECT_EQ(torque(range, 2.0, -0.1), -0.1) << "back";
  range = Narrowed(joint.limits, range, 1.95);
  EXPECT_EQ(range.upper_rad, 1.95) << "the way back is not open again";
  EXPECT_LT(torque(range, 2.0, 0.0), 0.0);
  range = Narrowed(joint.limits, range, 1.5);
  EXPECT_EQ(range.upper_rad, 1.9);
  EXPECT_EQ(Narrowed(joint.limits, range, 1.95).upper_rad, 1.9);
  EXPECT_EQ(RangeFrom(joint.limits, -2.0).lower_rad, -2.0);
  EXPECT_EQ(RangeFrom(joint.limits, 0.3).lower_rad, -1.9);
}

// --- a joint as a double integrator with everything that is declared at its worst

struct Trial {
  double inertia_kg_m2, efficiency, load_Nm;  // load: positive up
  double delay_s, period_s;
  double position_rad, velocity_rad_s;
  double silence_s = 0.0;    // measurements are lost for up to so long, again and again
  bool age_is_known = true;  // false: an old measurement counts as a new one
};

enum class Hostility { kFullOutwards, kRandomSwitching, kNoise, kNothing, kKinds };

struct Extent {
  double highest_rad, lowest_rad;
  double last_swing_Nm;  // of the torque in the last fifth of the time
};

Extent Drive(const JointConfig& joint, const Trial& trial, Hostility kind, double duration_s,
             std::mt19937* random) {
  constexpr int kSteps = 20;  // of a period
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const Envelope e = EnvelopeOf(joint, trial.period_s);
  double q = trial.position_rad, v = trial.velocity_rad_s;
  double commanded_Nm = e.motor_torque_Nm, acting_Nm = 0.0, lowest_Nm = 1e9, highest_Nm = -1e9;
  Extent extent{q, q, 0.0};
  std::deque<std::pair<long, double>> on_the_way;
  const double dt_s = trial.period_s / kSteps;
  const long delay = std::lround(trial.delay_s / dt_s);
  const long cycles = std::lround(duration_s / trial.period_s);
  PositionRange range = RangeFrom(joint.limits, q);
  MeasuredMotion measured;
  double measured_s = 0.0, silent_until_s = 0.0;
  for (long cycle = 0; cycle < cycles; ++cycle) {
    const double now_s = static_cast<double>(cycle) * trial.period_s;
    if (now_s >= silent_until_s) {
      measured = {v, q};
      measured_s = now_s;
      if (trial.silence_s > 0.0 && uniform(*random) < -0.8) {
        silent_until_s = now_s + trial.silence_s * std::abs(uniform(*random));
      }
    }
    if (trial.age_is_known) {
      measured.unknown_s = std::max(0.0, now_s - measured_s - trial.period_s);
    }
    switch (kind) {
      case Hostility::kFullOutwards:
        commanded_Nm = e.motor_torque_Nm;
        break;
      case Hostility::kRandomSwitching:
        if (uniform(*random) < -0.96) commanded_Nm = -commanded_Nm;
        break;
      case Hostility::kNoise:
        commanded_Nm = e.motor_torque_Nm * uniform(*random);
        break;
      default:
        commanded_Nm = 0.0;
        break;
    }
    range = Narrowed(joint.limits, range, measured.position_rad);
    const double torque_Nm = LimitTorque(joint.limits, e, range, measured, commanded_Nm);
    on_the_way.emplace_back(cycle * kSteps + delay, torque_Nm);
    if (cycle > cycles * 4 / 5) {
      lowest_Nm = std::min(lowest_Nm, torque_Nm);
      highest_Nm = std::max(highest_Nm, torque_Nm);
    }
    for (int i = 0; i < kSteps; ++i) {
      while (!on_the_way.empty() && on_the_way.front().first <= cycle * kSteps + i) {
        acting_Nm = on_the_way.front().second;
        on_the_way.pop_front();
      }
      const double output_Nm = trial.efficiency * joint.gear_ratio * acting_Nm;
      v += dt_s * (output_Nm + trial.load_Nm) / trial.inertia_kg_m2;
      q += dt_s * v;
      extent.highest_rad = std::max(extent.highest_rad, q);
      extent.lowest_rad = std::min(extent.lowest_rad, q);
    }
  }
  extent.last_swing_Nm = highest_Nm - lowest_Nm;
  return extent;
}

// The largest velocity at a distance from the limit that is inside the envelope.
double FastestInside(const JointConfig& joint, const Envelope& e, double distance_rad) {
  double low = 0.0, high = joint.limits.velocity_rad_s;
  for (int i = 0; i < 40; ++i) {
    const double v = 0.5 * (low + high);
    (v <= EnvelopeVelocity(e, DistanceAfterLatency(e, distance_rad, v)) ? low : high) = v;
  }
  return low;
}

// Over rates, delays and ratios of inertia; half of the trials begin on the envelope itself. The
// tolerance is the one stated by the envelope and 1e-3 rad of integration and sampling.
TEST(BrakingProperty, NoCommandMovesAJointBeyondItsLimitByMoreThanItsLoadDoes) {
  std::mt19937 random(16);
  std::uniform_real_distribution<double> part(0.0, 1.0);
  double worst_rad = -1.0, largest_share = 0.0;
  for (int n = 0; n < 4000; ++n) {
    JointConfig joint = BrakedJoint();
    joint.torque_efficiency = 0.6 + 0.4 * part(random);
    Braking& braking = *joint.limits.braking;
    braking.max_inertia_kg_m2 = braking.reflected_inertia_kg_m2 * std::exp(3.0 * part(random));
    braking.load_torque_Nm = 12.0 * part(random);
    braking.command_delay_s = 0.008 * part(random);
    Trial trial;
    trial.period_s = 1.0 / (100.0 + 900.0 * part(random));
    trial.delay_s = braking.command_delay_s;
    const double at = part(random) < 0.3 ? 0.0 : part(random) < 0.4 ? 1.0 : part(random);
    trial.inertia_kg_m2 = braking.reflected_inertia_kg_m2 +
                          at * (braking.max_inertia_kg_m2 - braking.reflected_inertia_kg_m2);
    trial.efficiency = joint.torque_efficiency + (1.0 - joint.torque_efficiency) * part(random);
    trial.load_Nm = braking.load_torque_Nm * (n % 3 == 0 ? 1.0 : 2.0 * part(random) - 1.0);
    const Envelope e = EnvelopeOf(joint, trial.period_s);
    const double distance_rad = 2.0 * part(random);
    trial.position_rad = joint.limits.upper_rad - distance_rad;
    const double inside_rad_s = FastestInside(joint, e, distance_rad);
    trial.velocity_rad_s = n % 2 == 0 ? inside_rad_s : inside_rad_s * (2.0 * part(random) - 1.0);
    const auto kind = static_cast<Hostility>(n % static_cast<int>(Hostility::kKinds));
    const Extent extent = Drive(joint, trial, kind, 1.5, &random);
    const double beyond_rad = extent.highest_rad - joint.limits.upper_rad;
    ASSERT_LE(beyond_rad, e.load_beyond_rad + 1e-3)
        << "trial " << n << ": inertia " << trial.inertia_kg_m2 << " of "
        << braking.max_inertia_kg_m2 << " kg m^2, load " << trial.load_Nm << " Nm, from "
        << trial.position_rad << " rad at " << trial.velocity_rad_s << " rad/s";
    ASSERT_GE(extent.lowest_rad, joint.limits.lower_rad - e.load_beyond_rad - 1e-3) << n;
    worst_rad = std::max(worst_rad, beyond_rad);
    if (e.load_beyond_rad > 0.01) {
      largest_share = std::max(largest_share, beyond_rad / e.load_beyond_rad);
    }
  }
  RecordProperty("worst_rad", std::to_string(worst_rad));
  RecordProperty("largest_share", std::to_string(largest_share));
  // It is a bound that is reached, not one that is far away.
  EXPECT_GT(largest_share, 0.8);
}

// The furthest beyond the limits of many trials in which measurements are lost for up to 60 ms.
double FurthestInSilence(bool age_is_known) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> part(0.0, 1.0);
  const JointConfig joint = BrakedJoint();
  double furthest_rad = 0.0;
  for (int n = 0; n < 400; ++n) {
    const Trial trial{.inertia_kg_m2 = 0.115 + 0.235 * part(random),
                      .efficiency = 0.77 + 0.23 * part(random),
                      .load_Nm = 16.0 * part(random) - 8.0,
                      .delay_s = 0.005,
                      .period_s = kRigPeriod_s,
                      .position_rad = 1.9 - 2.0 * part(random),
                      .velocity_rad_s = 0.0,
                      .silence_s = 0.06,
                      .age_is_known = age_is_known};
    const auto kind = static_cast<Hostility>(n % static_cast<int>(Hostility::kKinds));
    const Extent extent = Drive(joint, trial, kind, 2.0, &random);
    furthest_rad = std::max({furthest_rad, extent.highest_rad - 1.9, -1.9 - extent.lowest_rad});
  }
  return furthest_rad;
}

TEST(BrakingProperty, TheAgeOfAMeasurementCounts) {
  const double known_rad = FurthestInSilence(true), ignored_rad = FurthestInSilence(false);
  RecordProperty("known_rad", std::to_string(known_rad));
  RecordProperty("ignored_rad", std::to_string(ignored_rad));
  const double tolerance_rad = EnvelopeOf(BrakedJoint(), kRigPeriod_s).load_beyond_rad;
  EXPECT_LE(known_rad, tolerance_rad + 1e-3);
  EXPECT_GT(ignored_rad, 2.0 * tolerance_rad) << "the trials are hard ones";
}

TEST(BrakingProperty, AtTheLimitTheTorqueComesToRest) {
  std::mt19937 random(5);
  for (const double inertia : {0.115, 0.2, 0.35}) {
    for (const double load_Nm : {-8.0, 0.0, 8.0}) {
      const Trial trial{inertia, 0.9, load_Nm, 0.005, kRigPeriod_s, 0.5, 2.0};
      const Extent extent = Drive(BrakedJoint(), trial, Hostility::kFullOutwards, 3.0, &random);
      EXPECT_LT(extent.last_swing_Nm, 1e-3) << inertia << " kg m^2, " << load_Nm << " Nm";
    }
  }
}

}  // namespace
}  // namespace sinew::bridge
