// The tilt filter against the true attitude: its stated error, its stated delay, its start.
#include "components/robot/fall/tilt_filter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "tests/components/robot/fall/fall_world.h"

namespace sinew::fall {
namespace {

constexpr double kTiltPeriod_s = 1.0 / 240.0;

double AngleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

class Rig {
 public:
  explicit Rig(std::uint64_t seed, const TiltConfig& config = {})
      : filter(config, kTiltPeriod_s), sensors(seed, config.imu), check_(config.imu) {}

  void Step(const BodyState& body) {
    const double time_s = static_cast<double>(tick_) * kTiltPeriod_s;
    const ImuSample imu = sensors.Read(tick_, time_s, body).imu;
    ++tick_;
    filter.Step(imu, check_.Step(imu), kTiltPeriod_s);
  }
  void Stand(double duration_s, const BodyState& body = {}) {
    for (int i = 0; i < duration_s / kTiltPeriod_s; ++i) Step(body);
  }

  TiltFilter filter;
  SensorModel sensors;

 private:
  ImuCheck check_;
  std::uint64_t tick_ = 0;
};

TEST(TiltFilter, HasTheGainsOfItsDelay) {
  const TiltFilter filter(TiltConfig{}, kTiltPeriod_s);
  EXPECT_NEAR(filter.gain_1_s(), 0.015 * 9.81, 1e-12);
  EXPECT_NEAR(filter.gate_m_s2(), 0.7 + 1.0 + 0.2, 1e-12);
  EXPECT_NEAR(filter.error_bound_rad() / types::kDegree_rad, 7.3, 0.1);  // as the header's table
}

TEST(TiltFilter, KeepsItsErrorBoundOverAnHourOfStanding) {
  double worst_rad = 0.0;
  for (std::uint64_t seed = 0; seed < 2; ++seed) {
    Rig rig(seed);
    BodyState body;
    body.lean_rad = 2.0 * types::kDegree_rad;
    for (int i = 0; i < 3600 * 240; ++i) {
      rig.Step(body);
      if (rig.filter.started()) {
        worst_rad = std::max(worst_rad, AngleBetween(rig.filter.up(), body.up()));
      }
    }
    EXPECT_TRUE(rig.filter.started());
    EXPECT_NEAR(rig.filter.up().norm(), 1.0, 1e-12);
  }
  EXPECT_LT(worst_rad, TiltFilter(TiltConfig{}, kTiltPeriod_s).error_bound_rad());
  RecordProperty("worst_deg", std::to_string(worst_rad / types::kDegree_rad));
}

TEST(TiltFilter, KeepsItsErrorBoundInMotionWithItsLargestAcceleration) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Rig rig(seed);
    BodyState body;
    rig.Stand(3.0);
    ASSERT_TRUE(rig.filter.started()) << seed;
    double worst_rad = 0.0;
    for (int i = 0; i < 60 * 240; ++i) {
      const double phase = 1.2566 * i * kTiltPeriod_s;
      const double w = 1.2566, amplitude_rad = 6.0 * types::kDegree_rad;
      body.horizontal_m_s2 = std::cos(phase);
      body.lean_rad = amplitude_rad * std::sin(phase);
      body.lean_rad_s = amplitude_rad * w * std::cos(phase);
      body.lean_rad_s2 = -amplitude_rad * w * w * std::sin(phase);
      rig.Step(body);
      worst_rad = std::max(worst_rad, AngleBetween(rig.filter.up(), body.up()));
    }
    EXPECT_LT(worst_rad, rig.filter.error_bound_rad()) << seed;
  }
}

// Without noise, a point mass that tips over from rest: its specific force points along the rod, so
// that by it alone the robot would be upright all the way down.
TEST(TiltFilter, IsLateByItsStatedDelayInAFallThatTheSpecificForceDoesNotShow) {
  TiltFilter filter(TiltConfig{}, 1e-3);
  ImuSample imu;
  imu.valid = true;
  const ImuUse use{.rate_usable = true, .force_usable = true};
  imu.force_m_s2 = {0.0, 0.0, types::kGravity_m_s2};
  for (int i = 0; i < 3000; ++i) filter.Step(imu, use, 1e-3);
  ASSERT_TRUE(filter.started());
  double lean_rad = 0.001, lean_rad_s = 0.0, truth_s = 0.0, shown_s = 0.0;
  for (int i = 1; shown_s == 0.0 && i < 10000; ++i) {
    for (int k = 0; k < 10; ++k) {
      lean_rad_s += types::kGravity_m_s2 * std::sin(lean_rad) * 1e-4;
      lean_rad += lean_rad_s * 1e-4;
    }
    imu.rate_rad_s = {0.0, lean_rad_s, 0.0};
    imu.force_m_s2 = {0.0, 0.0,
                      types::kGravity_m_s2 * std::cos(lean_rad) - lean_rad_s * lean_rad_s};
    filter.Step(imu, use, 1e-3);
    if (truth_s == 0.0 && lean_rad > 30.0 * types::kDegree_rad) truth_s = i * 1e-3;
    if (filter.tilt_rad() > 30.0 * types::kDegree_rad) shown_s = i * 1e-3;
  }
  EXPECT_GT(shown_s, truth_s);
  EXPECT_LE(shown_s - truth_s, 0.015 + 1e-3);
}

TEST(TiltFilter, DoesNotStartWhileTheTorsoMoves) {
  Rig rig(5);
  BodyState body;
  for (int i = 0; i < 20 * 240; ++i) {
    const double phase = 3.0 * i * kTiltPeriod_s;
    body.lean_rad = 3.0 * types::kDegree_rad * std::sin(phase);
    body.lean_rad_s = 9.0 * types::kDegree_rad * std::cos(phase);
    rig.Step(body);
    ASSERT_FALSE(rig.filter.started()) << i;
  }
  body = BodyState{};
  rig.Stand(4.5, body);
  EXPECT_TRUE(rig.filter.started());
}

TEST(TiltFilter, StartsInTheSameTimeWhenReadFasterThanTheSensorMeasures) {
  for (const int repeats : {1, 2, 5}) {
    const double period_s = kTiltPeriod_s / repeats;
    TiltFilter filter(TiltConfig{}, period_s);
    ImuCheck check(TiltConfig{}.imu);
    SensorModel sensors(8, TiltConfig{}.imu);
    int steps = 0;
    while (!filter.started() && steps < 10 * 240 * repeats) {
      const auto measured = static_cast<std::uint64_t>(steps / repeats);
      const ImuSample imu =
          sensors.Read(measured, static_cast<double>(measured) * kTiltPeriod_s, BodyState{}).imu;
      filter.Step(imu, check.Step(imu), period_s);
      ++steps;
    }
    EXPECT_NEAR(steps * period_s, TiltConfig{}.start_s, 2.0 * kTiltPeriod_s) << repeats;
  }
}

TEST(TiltFilter, StartsInAnyAttitude) {
  Rig rig(6);
  BodyState lying;
  lying.lean_rad = 90.0 * types::kDegree_rad;
  rig.Stand(3.0, lying);
  ASSERT_TRUE(rig.filter.started());
  EXPECT_NEAR(rig.filter.tilt_rad() / types::kDegree_rad, 90.0, 6.0);
}

TEST(TiltFilter, CoastsOnTheGyroscopeWhileTheSpecificForceIsNotNearG) {
  Rig rig(7);
  rig.Stand(3.0);
  BodyState falling;
  falling.vertical_m_s2 = -types::kGravity_m_s2;
  rig.Stand(1.0, falling);
  EXPECT_NEAR(rig.filter.coasting_s(), 1.0, 0.01);
  EXPECT_LT(rig.filter.tilt_rad(), rig.filter.error_bound_rad());
  rig.Stand(0.1);
  EXPECT_LT(rig.filter.coasting_s(), 0.01);
}

TEST(TiltFilter, RefusesFiguresOutOfRange) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  TiltConfig length, delay, noise, range;
  length.pendulum_length_m = 0.0;
  delay.filter_delay_s = nan;
  noise.imu.rate_noise_rad_s = -1.0;
  range.imu.force_range_m_s2 = 9.0;
  for (const TiltConfig& config : {length, delay, noise, range}) {
    EXPECT_THROW(TiltFilter(config, kTiltPeriod_s), std::invalid_argument);
  }
  EXPECT_THROW(TiltFilter(TiltConfig{}, 0.0), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::fall
