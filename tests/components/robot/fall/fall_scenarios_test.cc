// Falls and healthy squats over 100 seeds each, with noise and bias of the IMU's bounds: every fall
// within 100 ms of the truth, no alarm in a squat.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "components/robot/fall/fall_detector.h"
#include "tests/components/robot/fall/fall_world.h"

namespace sinew::fall {
namespace {

constexpr int kSeeds = 100;
constexpr double kRequired_s = 0.100;
constexpr double kStart_s = 3.0;  // standing still first
constexpr double kTurn = types::kTwoPi;

// The loop of the biped and the bus that the thesis measured.
double RateOf(int seed) { return seed % 4 == 0 ? 82.0 : 240.0; }

struct Latency {
  std::optional<double> latency_s;  // from the truth's crossing to the alarm; empty: no alarm
  double since_fall_began_s = 0.0;
  Criterion criterion = Criterion::kNone;
};

// Moves a pendulum by `advance(body, since_s, step_s)` from kStart_s on, until half a second after
// the truth.
template <class Advance>
Latency LatencyOf(int seed, BodyState body, SensorModel* sensors, const Advance& advance) {
  const double period_s = 1.0 / RateOf(seed);
  FallDetector detector(FallConfig{}, period_s);
  std::optional<double> truth_s, alarm_s;
  Latency result;
  for (std::uint64_t tick = 0; tick < 20000; ++tick) {
    const double time_s = static_cast<double>(tick) * period_s;
    const bool falls = time_s >= kStart_s;
    constexpr int kSubsteps = 20;
    for (int i = 0; falls && i < kSubsteps; ++i) {
      const double step_s = period_s / kSubsteps;
      advance(&body, time_s - kStart_s + i * step_s, step_s);
      if (!truth_s && body.fallen()) truth_s = time_s - period_s + (i + 1) * step_s;
    }
    const FallOutput out = detector.Step(sensors->Read(tick, time_s, body));
    if (out.state == FallState::kFalling && !alarm_s) {
      alarm_s = time_s;
      result.criterion = out.criterion;
    }
    if (!falls && time_s > kStart_s - 0.5) {
      EXPECT_EQ(out.state, FallState::kUpright) << "seed " << seed << " before the fall";
    }
    if (truth_s && time_s > *truth_s + 0.5) break;
  }
  EXPECT_TRUE(truth_s) << "seed " << seed << ": this is no fall";
  if (truth_s && alarm_s) {
    result.latency_s = *alarm_s - *truth_s;
    result.since_fall_began_s = *alarm_s - kStart_s;
  }
  return result;
}

template <class Fall>
void ExpectFoundInTime(const char* name, const Fall& fall) {
  double latest_s = -1e9, earliest_s = 1e9;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const Latency latency = fall(seed);
    ASSERT_TRUE(latency.latency_s) << name << " of seed " << seed << " was not found";
    EXPECT_LE(*latency.latency_s, kRequired_s)
        << name << ", seed " << seed << ", by " << static_cast<int>(latency.criterion);
    EXPECT_GE(latency.since_fall_began_s, 0.0) << name << ", seed " << seed;
    latest_s = std::max(latest_s, *latency.latency_s);
    earliest_s = std::min(earliest_s, *latency.latency_s);
  }
  ::testing::Test::RecordProperty("earliest_ms", std::to_string(1e3 * earliest_s));
  ::testing::Test::RecordProperty("latest_ms", std::to_string(1e3 * latest_s));
}

// Semi-implicit Euler at 1/20 of a tick: 0.2 ms at 240 Hz.
void TipOver(BodyState* body, double pivot_m_s2, double step_s) {
  constexpr double kLength_m = 1.0;
  body->horizontal_m_s2 = pivot_m_s2;
  body->lean_rad_s2 =
      (types::kGravity_m_s2 * std::sin(body->lean_rad) - pivot_m_s2 * std::cos(body->lean_rad)) /
      kLength_m;
  body->lean_rad_s += body->lean_rad_s2 * step_s;
  body->lean_rad += body->lean_rad_s * step_s;
}

Latency TippingOver(int seed, double direction_rad) {
  SensorModel sensors(static_cast<std::uint64_t>(seed) + 1000);
  BodyState body;
  body.direction_rad = direction_rad;
  body.imu_height_m = sensors.Between(0.5, 1.0);
  const double push_rad_s = sensors.Between(0.02, 1.0);
  bool pushed = false;
  return LatencyOf(seed, body, &sensors, [&](BodyState* b, double, double step_s) {
    if (!pushed) b->lean_rad_s = push_rad_s;
    pushed = true;
    TipOver(b, 0.0, step_s);
  });
}

TEST(FallScenarios, AFallForwardsOrBackwardsIsFoundInTime) {
  ExpectFoundInTime("fall forwards",
                    [](int seed) { return TippingOver(seed, seed % 2 == 0 ? 0.0 : 0.5 * kTurn); });
}

TEST(FallScenarios, AFallToTheSideIsFoundInTime) {
  ExpectFoundInTime("fall to the side", [](int seed) {
    return TippingOver(seed, seed % 2 == 0 ? 0.25 * kTurn : -0.25 * kTurn);
  });
}

TEST(FallScenarios, ASlipIsFoundInTime) {
  ExpectFoundInTime("slip", [](int seed) {
    SensorModel sensors(static_cast<std::uint64_t>(seed) + 2000);
    BodyState body;
    body.direction_rad = sensors.Between(0.0, kTurn);
    const double slide_m_s2 = -sensors.Between(2.0, 6.0), slide_s = sensors.Between(0.1, 0.4);
    return LatencyOf(seed, body, &sensors, [&](BodyState* b, double since_s, double step_s) {
      TipOver(b, since_s < slide_s ? slide_m_s2 : 0.0, step_s);
    });
  });
}

// The legs give way and carry only a share of the weight.
TEST(FallScenarios, ACollapseOfTheLegsIsFoundInTime) {
  ExpectFoundInTime("collapse", [](int seed) {
    SensorModel sensors(static_cast<std::uint64_t>(seed) + 3000);
    const double carried = sensors.Between(0.0, 0.9);
    double sink_m_s = 0.0;
    return LatencyOf(seed, BodyState{}, &sensors, [&](BodyState* b, double, double step_s) {
      const bool on_ground = b->leg_m < 0.15;
      b->vertical_m_s2 = on_ground ? 0.0 : -(1.0 - carried) * types::kGravity_m_s2;
      b->load_share = on_ground ? 1.0 : carried;
      sink_m_s = on_ground ? 0.0 : sink_m_s - b->vertical_m_s2 * step_s;
      b->leg_m -= sink_m_s * step_s;
    });
  });
}

// Legs that fold while the robot squats: the reference falls, too, and the base falls below it.
TEST(FallScenarios, ACollapseInASquatIsFoundInTime) {
  ExpectFoundInTime("collapse in a squat", [](int seed) {
    SensorModel sensors(static_cast<std::uint64_t>(seed) + 4000);
    const double at_s = sensors.Between(0.0, 5.0), carried = sensors.Between(0.3, 0.9);
    double sink_m_s = 0.0;
    return LatencyOf(seed, BodyState{}, &sensors, [&](BodyState* b, double since_s, double step_s) {
      const double w = kTurn * 0.2;
      b->reference_m = 0.45 + 0.2 * std::cos(w * since_s);
      if (since_s < at_s) {
        b->leg_m = b->reference_m;
        sink_m_s = 0.2 * w * std::sin(w * since_s);
        b->vertical_m_s2 = -0.2 * w * w * std::cos(w * since_s);
        return;
      }
      const bool on_ground = b->leg_m < 0.1;
      b->vertical_m_s2 = on_ground ? 0.0 : -(1.0 - carried) * types::kGravity_m_s2;
      b->load_share = on_ground ? 1.0 : carried;
      sink_m_s = on_ground ? 0.0 : sink_m_s - b->vertical_m_s2 * step_s;
      b->leg_m -= sink_m_s * step_s;
    });
  });
}

// A push that is too slow for the gyroscope to matter: only the specific force shows it.
TEST(FallScenarios, ASlowLeanIsFoundInTime) {
  ExpectFoundInTime("slow lean", [](int seed) {
    SensorModel sensors(static_cast<std::uint64_t>(seed) + 5000);
    BodyState body;
    body.direction_rad = sensors.Between(0.0, kTurn);
    const double lean_rad_s = sensors.Between(2.0, 20.0) * types::kDegree_rad;
    return LatencyOf(seed, body, &sensors, [&](BodyState* b, double, double step_s) {
      b->lean_rad_s = lean_rad_s;
      b->lean_rad += lean_rad_s * step_s;
    });
  });
}

// Two cycles in 10 s from 0.65 m to 0.25 m: late by up to 50 ms, the torso pitches and sways, load
// moves between feet, heel and toe, and impacts of up to 4 g ring at 20 to 60 Hz.
TEST(FallScenarios, HealthySquatsRaiseNoAlarm) {
  double most_tilt_rad = 0.0, least_share = 1.0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    SensorModel sensors(static_cast<std::uint64_t>(seed) + 6000);
    const double period_s = 1.0 / RateOf(seed);
    FallDetector detector(FallConfig{}, period_s);
    const double w = kTurn * 0.2, late_s = sensors.Between(0.0, 0.05);
    const double pitch_rad = sensors.Between(2.0, 8.0) * types::kDegree_rad;
    const double sway_rad = sensors.Between(0.0, 0.7) * types::kDegree_rad;
    const double sway_rad_s = kTurn * sensors.Between(0.8, 2.5);
    const double direction_rad = sensors.Between(-0.5, 0.5);
    double shock_at_s = kStart_s + 0.3, ring_Hz = 30.0;
    Eigen::Vector3d shock = Eigen::Vector3d::Zero();
    const auto ticks = static_cast<std::uint64_t>((kStart_s + 10.0) / period_s);
    for (std::uint64_t tick = 0; tick <= ticks; ++tick) {
      const double time_s = static_cast<double>(tick) * period_s;
      const double t_s = std::max(0.0, time_s - kStart_s);
      BodyState body;
      body.direction_rad = direction_rad;
      body.leg_vertical = true;
      body.reference_m = 0.45 + 0.2 * std::cos(w * t_s);
      const double phase = w * std::max(0.0, t_s - late_s);
      body.leg_m = 0.45 + 0.2 * std::cos(phase);
      const bool moves = t_s > late_s;
      body.vertical_m_s2 = moves ? -0.2 * w * w * std::cos(phase) : 0.0;
      if (moves) {
        const double sway_phase = sway_rad_s * (t_s - late_s);
        body.lean_rad = 0.5 * pitch_rad * (1.0 - std::cos(phase)) + sway_rad * std::sin(sway_phase);
        body.lean_rad_s =
            0.5 * pitch_rad * w * std::sin(phase) + sway_rad * sway_rad_s * std::cos(sway_phase);
        body.lean_rad_s2 = 0.5 * pitch_rad * w * w * std::cos(phase) -
                           sway_rad * sway_rad_s * sway_rad_s * std::sin(sway_phase);
        body.right_share = 0.5 + 0.4 * std::sin(1.7 * t_s);
        body.toe_share = 0.5 + 0.45 * std::sin(2.9 * t_s);
      }
      body.load_share = 1.0 + body.vertical_m_s2 / types::kGravity_m_s2;
      if (time_s > shock_at_s + 0.2) {
        shock_at_s = time_s + sensors.Between(0.1, 1.0);
        ring_Hz = sensors.Between(20.0, 60.0);
        shock = {sensors.Uniform(15.0), sensors.Uniform(15.0), sensors.Uniform(40.0)};
      }
      const double ring_s = time_s - shock_at_s;
      const bool rings = ring_s >= 0.0 && t_s > 0.0;
      const double ring =
          rings ? std::exp(-ring_s / 0.02) * std::cos(kTurn * ring_Hz * ring_s) : 0.0;
      const FallOutput out = detector.Step(sensors.Read(tick, time_s, body, ring * shock));
      if (time_s < kStart_s - 0.5) continue;
      ASSERT_EQ(out.state, FallState::kUpright)
          << "seed " << seed << " at " << t_s << " s: " << static_cast<int>(out.criterion) << " "
          << UnknownName(out.unknown) << ", tilt " << out.tilt_rad << ", share "
          << out.height_share;
      most_tilt_rad = std::max(most_tilt_rad, out.tilt_rad);
      least_share = std::min(least_share, out.height_share);
    }
  }
  RecordProperty("most_tilt_deg", std::to_string(most_tilt_rad / types::kDegree_rad));
  RecordProperty("least_height_share", std::to_string(least_share));
}

}  // namespace
}  // namespace sinew::fall
