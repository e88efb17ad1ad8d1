#include "components/robot/reference/squat.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "tests/support/allocations.h"

namespace sinew::reference {
namespace {

using ::testing::HasSubstr;

constexpr double kExactHeight_m = 1e-12;

leg::LegGeometry TableLeg() {
  leg::LegGeometry g;
  g.hip_in_pelvis_m = {0.0, 0.075, 0.0};
  g.thigh_m = 0.278;
  g.shank_m = 0.260;
  g.ankle_offset_m = 0.104;
  g.sole_in_ankle_m = {0.0, 0.0, -0.134};
  return g;
}

std::string SquatErrorOf(const std::function<void()>& act) {
  try {
    act();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "no error";
}

// Central differences: their error is step^2 times a third derivative, and rounding over the step.
void ExpectExactDerivatives(const Trajectory& trajectory, double step_s, double tolerance) {
  constexpr double kEvery_s = 0.0371;
  for (double t = step_s; t < trajectory.duration_s() - step_s; t += kEvery_s) {
    const Point a = trajectory.At(t - step_s), b = trajectory.At(t), c = trajectory.At(t + step_s);
    ASSERT_NEAR(b.velocity_rad_s, (c.position_rad - a.position_rad) / (2.0 * step_s),
                tolerance * (1.0 + std::abs(b.acceleration_rad_s2)))
        << t;
    ASSERT_NEAR(b.acceleration_rad_s2, (c.velocity_rad_s - a.velocity_rad_s) / (2.0 * step_s),
                tolerance * (1.0 + std::abs(b.acceleration_rad_s2)))
        << t;
  }
}

TEST(SquatHeight, GoesFromTopToBottomAndBackInEveryCycle) {
  SquatsConfig config;
  config.cycles = 6;
  const TrajectoryPtr squats = MakeSquats(config);
  EXPECT_EQ(squats->duration_s(), 30.0);
  for (int i = 0; i <= 6; ++i) {
    EXPECT_NEAR(squats->At(5.0 * i).position_rad, -0.02, kExactHeight_m);
    EXPECT_NEAR(squats->At(5.0 * i).velocity_rad_s, 0.0, kExactHeight_m);
    if (i == 6) break;
    EXPECT_NEAR(squats->At(5.0 * i + 2.5).position_rad, -0.4, kExactHeight_m);
  }
  ExpectExactDerivatives(*squats, 1e-5, 1e-6);
}

TEST(SquatHeight, IsAtRestBeforeAndAfter) {
  const TrajectoryPtr squats = MakeSquats({});
  for (const double time_s : {-3.0, -1e-9, 10.0 + 1e-9, 12.5}) {
    EXPECT_NEAR(squats->At(time_s).position_rad, -0.02, kExactHeight_m) << time_s;
    EXPECT_EQ(squats->At(time_s).velocity_rad_s, 0.0) << time_s;
    EXPECT_EQ(squats->At(time_s).acceleration_rad_s2, 0.0) << time_s;
  }
  // The step at the beginning that squat.h states.
  EXPECT_NEAR(squats->At(0.0).acceleration_rad_s2, -0.3, 0.001);
}

TEST(SquatHeight, RefusesWhatNoLegCanDo) {
  const auto error = [](const SquatsConfig& c) {
    return SquatErrorOf([&c] { static_cast<void>(MakeSquats(c)); });
  };
  EXPECT_THAT(error({.straight_margin_m = 0.0}), HasSubstr("expected 0 < margin < depth"));
  EXPECT_THAT(error({.straight_margin_m = 0.5}), HasSubstr("expected 0 < margin < depth"));
  EXPECT_THAT(error({.depth_m = std::numeric_limits<double>::infinity()}), HasSubstr("depth inf"));
  EXPECT_THAT(error({.cycles = 0}), HasSubstr("0 squats"));
  EXPECT_THAT(error({.period_s = 0.8}), HasSubstr("expected less than 1 g"));
}

TEST(SquatHeight, TheChirpKeepsItsDepthAndItsAcceleration) {
  const ChirpSquatConfig config;
  const ChirpSquat chirp(config);
  EXPECT_EQ(chirp.duration_s(), 200.0);
  double largest_m_s2 = 0.0, lowest_m = 0.0, highest_m = -1.0;
  for (int i = 0; i <= 200000; ++i) {
    const Point z = chirp.At(i * 1e-3);
    largest_m_s2 = std::max(largest_m_s2, std::abs(z.acceleration_rad_s2));
    lowest_m = std::min(lowest_m, z.position_rad);
    highest_m = std::max(highest_m, z.position_rad);
  }
  constexpr double kGridError = 1e-3;  // the limit is kept on a grid of 5 ms
  EXPECT_LT(largest_m_s2, config.acceleration_m_s2 * (1.0 + kGridError));
  EXPECT_GT(largest_m_s2, config.acceleration_m_s2 * (1.0 - kGridError));
  EXPECT_GE(lowest_m, -0.4);
  EXPECT_LT(lowest_m, -0.39);
  EXPECT_LE(highest_m, -0.02);
  EXPECT_GT(highest_m, -0.03);
  EXPECT_LT(chirp.end_amplitude_m(), 0.12);
  EXPECT_GT(chirp.end_amplitude_m(), 0.05);
}

// Where the limit does not act, the chirp is the published one, read as -200 + 50 y mm.
TEST(SquatHeight, TheChirpIsThePublishedOneWhereNothingLimitsIt) {
  ChirpSquatConfig config;
  config.straight_margin_m = 1e-9;
  config.shape.end_frequency_Hz = 0.15;  // slow to the end
  const ChirpSquat chirp(config);
  const Chirp published(config.shape);
  constexpr double kLimitStillActs_m = 1e-3;
  for (double t = 0.0; t < 200.0; t += 0.1) {
    ASSERT_NEAR(chirp.At(t).position_rad, -0.2 + 0.05 * published.Unscaled(t).position_rad,
                kLimitStillActs_m);
  }
}

TEST(SquatHeight, TheChirpsDerivativesAreExact) {
  ExpectExactDerivatives(ChirpSquat({}), 1e-5, 1e-6);
  ChirpSquatConfig fast;  // so that the derivatives of the limited amplitude matter
  fast.shape.duration_s = 10.0;
  ExpectExactDerivatives(ChirpSquat(fast), 1e-5, 1e-6);
}

TEST(SquatHeight, TheChirpRefusesOneGAndMore) {
  const auto error = [](double acceleration_m_s2) {
    return SquatErrorOf([=] { ChirpSquat({.acceleration_m_s2 = acceleration_m_s2}); });
  };
  EXPECT_THAT(error(9.81), HasSubstr("below 1 g"));
  EXPECT_THAT(error(0.0), HasSubstr("above 0"));
  EXPECT_THAT(error(std::nan("")), HasSubstr("nan"));
}

TEST(SquatTrajectory, FollowsTheBaseAndHasExactDerivatives) {
  const leg::LegGeometry g = TableLeg();
  for (const TrajectoryPtr& height :
       {MakeSquats({}), TrajectoryPtr(std::make_shared<ChirpSquat>(ChirpSquatConfig{}))}) {
    const SquatTrajectory hip(height, g, 0.0, SquatJoint::kHipPitch);
    const SquatTrajectory knee(height, g, 0.0, SquatJoint::kKnee);
    const SquatTrajectory ankle(height, g, 0.0, SquatJoint::kAnklePitch);
    for (double t = 0.0; t <= height->duration_s(); t += 0.173) {
      leg::LegAngles q = leg::LegAngles::Zero();
      q[leg::kHipPitch] = hip.At(t).position_rad;
      q[leg::kKnee] = knee.At(t).position_rad;
      q[leg::kAnklePitch] = ankle.At(t).position_rad;
      const Eigen::Vector3d sole = leg::Forward(g, q).translation();
      const Eigen::Vector3d expected(0.0, 0.075, -0.776 - height->At(t).position_rad);
      ASSERT_LT((sole - expected).norm(), 1e-12) << t;
    }
    for (const SquatTrajectory* joint : {&hip, &knee, &ankle}) {
      ExpectExactDerivatives(*joint, 1e-5, 1e-6);
    }
  }
}

TEST(SquatTrajectory, RefusesADepthThatTheLegDoesNotReach) {
  SquatsConfig deep;
  deep.depth_m = 0.53;
  const auto act = [&] { SquatTrajectory(MakeSquats(deep), TableLeg(), 0.0, SquatJoint::kKnee); };
  EXPECT_THAT(SquatErrorOf(act), HasSubstr("does not reach the base height -0.53 m"));
  const auto forward = [] { SquatTrajectory(MakeSquats({}), TableLeg(), 0.6, SquatJoint::kKnee); };
  EXPECT_THAT(SquatErrorOf(forward), HasSubstr("does not reach"));
  EXPECT_THAT(SquatErrorOf([] { SquatTrajectory(nullptr, TableLeg(), 0, SquatJoint::kKnee); }),
              HasSubstr("no base height"));
  EXPECT_THAT(SquatErrorOf([] {
                SquatTrajectory(std::make_shared<Hold>(-0.1), TableLeg(), 0, SquatJoint::kKnee);
              }),
              HasSubstr("never ends"));
}

TEST(SquatTrajectory, IsFiniteForAnyTimeAndAllocatesNothing) {
  const SquatTrajectory knee(std::make_shared<ChirpSquat>(ChirpSquatConfig{}), TableLeg(), 0.0,
                             SquatJoint::kKnee);
  const long before = test::Allocations();
  bool finite = true;
  for (double t = -60.0; t < 300.0; t += 0.01) {
    const Point p = knee.At(t);
    finite = finite && std::isfinite(p.position_rad) && std::isfinite(p.velocity_rad_s) &&
             std::isfinite(p.acceleration_rad_s2);
  }
  EXPECT_TRUE(finite);
  EXPECT_EQ(test::Allocations(), before);
}

TEST(SquatLimits, TheFirstThatIsPassedIsNamedWithJointAndValue) {
  const Sine sine({.amplitude_rad = 1.0, .frequency_Hz = 0.5, .duration_s = 2.0});
  EXPECT_EQ(FirstPassedLimit("k", sine, {}), "");
  EXPECT_EQ(FirstPassedLimit("k", sine, {.position_lower_rad = -0.5}),
            "joint 'k': position reaches -1 rad, limit -0.5 rad");
  EXPECT_THAT(FirstPassedLimit("k", sine, {.position_upper_rad = 0.9}), HasSubstr("reaches 1 rad"));
  EXPECT_EQ(FirstPassedLimit("k", sine, {.velocity_rad_s = 3.0}),
            "joint 'k': velocity reaches 3.14159 rad/s, limit 3 rad/s");
  EXPECT_THAT(FirstPassedLimit("k", sine, {.acceleration_rad_s2 = 9.0}),
              HasSubstr("acceleration reaches 9.8696 rad/s2, limit 9 rad/s2"));
}

}  // namespace
}  // namespace sinew::reference
