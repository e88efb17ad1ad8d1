// Oracles: closed forms of sines.
#include "tools/tracking/tracking.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace sinew::tools {
namespace {

using types::Signal;
constexpr double kPi = std::numbers::pi;
// The trapezoidal rule over whole periods of a smooth periodic function is exact to rounding.
constexpr double kTolerance = 1e-12;

// One second: the error is a sine of `amplitude`, torque and velocity are in phase.
types::Run SineRun(double amplitude, int samples = 1001) {
  types::Run run;
  run.name = "sine";
  run.time_s = Eigen::VectorXd::LinSpaced(samples, 0.0, 1.0);
  const Eigen::VectorXd wave = (2.0 * kPi * run.time_s.array()).sin();
  run.signals[Signal::kPosition] = 0.3 * wave;
  run.signals[Signal::kReferencePosition] = (0.3 + amplitude) * wave;
  run.signals[Signal::kTorque] = 2.0 * wave;
  run.signals[Signal::kVelocity] = 3.0 * wave;
  run.signals[Signal::kMotorCurrent] = -4.0 * wave;
  return run;
}

TEST(Tracking, PerfectFollowingScoresZero) {
  const TrackingScore score = ScoreTracking(SineRun(0.0));
  EXPECT_EQ(score.mean_square_error_rad2, 0.0);
  EXPECT_EQ(score.max_error_rad, 0.0);
}

TEST(Tracking, ASineErrorHasHalfItsSquaredAmplitude) {
  const TrackingScore score = ScoreTracking(SineRun(0.2));
  EXPECT_NEAR(score.mean_square_error_rad2, 0.02, kTolerance);
  EXPECT_NEAR(score.rms_error_rad, 0.2 / std::sqrt(2.0), kTolerance);
  EXPECT_NEAR(score.max_error_rad, 0.2, kTolerance);
  EXPECT_NEAR(score.rms_torque_Nm, std::sqrt(2.0), kTolerance);
  EXPECT_NEAR(score.rms_current_A, 4.0 / std::sqrt(2.0), kTolerance);
  EXPECT_NEAR(score.duration_s, 1.0, kTolerance);
}

TEST(Tracking, WorkCountsOnlyPowerThatGoesIntoTheLink) {
  types::Run run = SineRun(0.2);
  EXPECT_NEAR(ScoreTracking(run).positive_work_J, 3.0, kTolerance) << "2 * 3 * mean of sin^2";
  run.signals[Signal::kVelocity] *= -1.0;
  EXPECT_EQ(ScoreTracking(run).positive_work_J, 0.0);
}

TEST(Tracking, UnevenSamplesWeighByTheirTime) {
  types::Run run;
  run.time_s = Eigen::Vector3d(0.0, 3.0, 4.0);
  run.signals[Signal::kPosition] = Eigen::Vector3d::Zero();
  run.signals[Signal::kReferencePosition] = Eigen::Vector3d(1.0, 1.0, 0.0);
  const TrackingScore score = ScoreTracking(run);
  EXPECT_NEAR(score.mean_square_error_rad2, (3.0 + 0.5) / 4.0, kTolerance);
  EXPECT_FALSE(score.has_torque);
  EXPECT_FALSE(score.has_current);
}

TEST(Tracking, TheStartCanBeLeftOut) {
  types::Run run = SineRun(0.2);
  run.signals[Signal::kReferencePosition].head(500).setConstant(100.0);
  EXPECT_NEAR(ScoreTracking(run, 0.5).mean_square_error_rad2, 0.02, 1e-6)
      << "half a period, ends included";
  EXPECT_NEAR(ScoreTracking(run, 0.5).duration_s, 0.5, kTolerance);
}

TEST(Tracking, NonFiniteSamplesGiveANonFiniteScore) {
  types::Run run = SineRun(0.2);
  run.signals[Signal::kPosition][10] = std::nan("");
  EXPECT_TRUE(std::isnan(ScoreTracking(run).mean_square_error_rad2));
}

TEST(Tracking, MissingSignalsAndTooFewSamplesAreRefused) {
  types::Run run = SineRun(0.2);
  EXPECT_THROW(ScoreTracking(run, 1.0), std::invalid_argument);
  EXPECT_THROW(ScoreTracking(run, 1e9), std::invalid_argument);
  run.signals.erase(Signal::kReferencePosition);
  EXPECT_THROW(ScoreTracking(run), std::invalid_argument);
  EXPECT_THROW(ScoreTracking(types::Run{}), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::tools
