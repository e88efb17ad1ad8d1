// Oracle: strokes with a torque balance that was put in.
#include "components/model/experiment/push.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

#include "tests/support/rig_constants.h"

namespace sinew::experiment {
namespace {

constexpr double kHalf_rad = 0.0232;
constexpr double kInertia_kg_m2 = 0.019;

struct Truth {
  double slope_Nm_bar = 0.3587, friction_Nm = 0.22, gravity_Nm = 0.58;
  double gas_Nm_rad = 0.0;  // at 6 bar
};

// Pushes from 6 bar down to last_bar; each takes 2 s. Speed of a stroke wobbles, as a hand's does.
Recording Pushes(const Truth& truth, double last_bar, int pushes, double noise_N = 0.05,
                 bool shut = false) {
  std::mt19937 random(4);
  std::normal_distribution<double> gauss;
  Recording rows;
  for (int i = 0; i < pushes * 480; ++i) {
    const double t = i / 240.0, local = std::fmod(t, 2.0);
    const double pressure_bar = 6.0 - (6.0 - last_bar) * t / (2.0 * pushes);
    double q = kHalf_rad, v = 0.0, a = 0.0;
    int direction = 0;
    const auto stroke = [&](double x, double sign) {  // x from 0 to 1 over 0.4 s
      const double w = 4.0 * std::numbers::pi;
      q = sign * kHalf_rad * (-1.0 + 2.0 * (x - 0.4 * std::sin(w * x) / w));
      v = sign * 2.0 * kHalf_rad * (1.0 - 0.4 * std::cos(w * x)) / 0.4;
      a = sign * 2.0 * kHalf_rad * 0.4 * w * std::sin(w * x) / 0.16;
      direction = sign > 0.0 ? 1 : -1;
    };
    double force_N = 0.0;
    if (local < 0.4) {
      force_N = 0.0;
    } else if (local < 0.8) {
      stroke((local - 0.4) / 0.4, -1.0);
    } else if (local < 1.2) {
      q = -kHalf_rad;
      force_N = 9.0;
    } else if (local < 1.6) {
      stroke((local - 1.2) / 0.4, 1.0);
    }
    if (direction != 0) {
      const double gas_Nm = -truth.gas_Nm_rad * (pressure_bar + 1.013) / 7.013 * q;
      force_N = (truth.slope_Nm_bar * pressure_bar + gas_Nm - direction * truth.friction_Nm -
                 truth.gravity_Nm * std::cos(q) - kInertia_kg_m2 * a) /
                0.3;
    }
    Row row;
    row.time_s = t;
    row.output_angle_rad = kCount_rad * std::round((q + 1.5e-4 * gauss(random)) / kCount_rad);
    row.output_velocity_rad_s = v;
    row.load_force_N = force_N + noise_N * gauss(random);
    row.chamber_pressure_bar = pressure_bar + 0.006 * gauss(random);
    row.valve_open = !shut;
    rows.push_back(row);
  }
  return rows;
}

TEST(HannWindow, MeanAccelerationOfAParabolaIsItsOwn) {
  Recording rows;
  for (int i = 0; i <= 240; ++i) {
    Row row;
    row.time_s = i / 240.0;
    row.output_angle_rad = 0.3 + 0.2 * row.time_s + 0.5 * 1.7 * row.time_s * row.time_s;
    row.load_force_N = 4.0;
    rows.push_back(row);
  }
  const WindowMean mean = HannMean(rows, 0, rows.size() - 1);
  EXPECT_NEAR(mean.acceleration_rad_s2(), 1.7, 1e-3);
  EXPECT_NEAR(mean.force_N, 4.0, 1e-12);
  EXPECT_NEAR(mean.time_s, 0.5, 1e-12);
}

TEST(Pushes, SlopeFrictionAndGravityComeBackThoughTheHandWobbles) {
  const Result result = IdentifyMovingFriction(Pushes({}, 2.6, 40), {});
  const Truth truth;
  EXPECT_NEAR(result.Find("pressure_slope_Nm_bar")->estimate.value, truth.slope_Nm_bar,
              0.005 * truth.slope_Nm_bar);
  EXPECT_NEAR(result.Find("moving_friction_Nm")->estimate.value, truth.friction_Nm,
              0.02 * truth.friction_Nm);
  EXPECT_NEAR(result.Find("gravity_moving_Nm")->estimate.value, truth.gravity_Nm,
              0.02 * truth.gravity_Nm);
  EXPECT_EQ(result.Find("moving_friction_Nm")->estimate.trials, 80);  // 40 down, 40 up
}

TEST(Pushes, AWrongAssumedGravityGoesIntoThePublishedFrictionOnly) {
  RigConstants rig;
  rig.gravity_torque_Nm = 0.68;
  const Result result = IdentifyMovingFriction(Pushes({}, 2.6, 40), rig);
  EXPECT_NEAR(result.Find("moving_friction_down_Nm")->estimate.value, 0.32, 0.01);
  EXPECT_NEAR(result.Find("moving_friction_Nm")->estimate.value, 0.22, 0.005);
}

TEST(Stiffness, SecantIsTorqueOverPlayAndFallsWithPressure) {
  const Result result = IdentifyStiffness(Pushes({}, 2.6, 40), {});
  const double play_rad = 2.0 * kHalf_rad;
  const double expected = (6.0 * 0.3587 + 0.22 - 0.58) / play_rad;
  EXPECT_NEAR(result.Find("secant_6bar_Nm_rad")->estimate.value, expected, 0.02 * expected);
  EXPECT_NEAR(result.Find("return_limit_bar")->estimate.value, (0.58 + 0.22) / 0.3587, 0.05);
}

TEST(Stiffness, GasStiffnessOfShutStrokesComesBackAndIsNothingWithoutGas) {
  Truth truth;
  truth.gas_Nm_rad = 1.3;
  // Half the pushes with the chamber shut.
  Recording rows = Pushes({}, 3.5, 30);
  for (Row row : Pushes(truth, 3.0, 30, 0.05, true)) {
    row.time_s += 60.0;
    rows.push_back(row);
  }
  const Result result = IdentifyStiffness(rows, {});
  const Estimate shut = result.Find("gas_shut_Nm_rad")->estimate;
  const Estimate open = result.Find("gas_open_Nm_rad")->estimate;
  EXPECT_NEAR(shut.value, 1.3, 0.2);
  EXPECT_NEAR(open.value, 0.0, 0.2);
}

TEST(Stiffness, APushThatFoundTheLinkBelowHasNoSecant) {
  Recording rows = Pushes({}, 2.6, 20);
  const double end_s = rows.back().time_s;
  for (int i = 0; i < 960; ++i) {  // two pushes on a link that stays at the lower contact
    Row row;
    row.time_s = end_s + (i + 1) / 240.0;
    row.output_angle_rad = -kHalf_rad;
    row.chamber_pressure_bar = 1.8;
    row.load_force_N = i % 480 < 240 ? 5.0 : 0.0;
    row.valve_open = true;
    rows.push_back(row);
  }
  const Play play = FindStrokes(rows);
  int stuck = 0;
  for (const Play::Push& push : play.pushes) stuck += push.passed ? 0 : 1;
  EXPECT_EQ(stuck, 2);
  EXPECT_FALSE(IdentifyStiffness(rows, {}).remarks.empty());
}

TEST(Pushes, ALinkThatNeverMovedOrAnEmptyRecordingIsRefused) {
  Recording still(600);
  for (std::size_t i = 0; i < still.size(); ++i) still[i].time_s = static_cast<double>(i) / 240.0;
  EXPECT_THROW((void)IdentifyMovingFriction(still, {}), std::invalid_argument);
  EXPECT_THROW((void)IdentifyStiffness({}, {}), std::invalid_argument);
  EXPECT_THROW(PushProtocol({.first_bar = 2.0, .last_bar = 3.0}), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::experiment
