// Error, sliding RMSE (7.7) and MSE of a joint, against direct sums.
#include "components/robot/performance/joint_performance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>
#include <vector>

#include "tests/support/allocations.h"

namespace sinew::performance {
namespace {

constexpr double kJointPeriod_s = 1.0 / 240.0;
constexpr double kNotSampled = std::numeric_limits<double>::quiet_NaN();

JointSample WithError(double error_rad) {
  return {.reference_rad = 0.5 + error_rad,
          .position_rad = 0.5,
          .velocity_rad_s = 1.0,
          .torque_Nm = 2.0,
          .current_A = 1.0};
}

TEST(JointPerformance, IsZeroWithoutError) {
  JointPerformance joint({}, kJointPeriod_s);
  JointPerformanceOutput out;
  for (std::uint64_t tick = 0; tick < 500; ++tick) out = joint.Step(tick, WithError(0.0));
  EXPECT_TRUE(out.rms_known);
  EXPECT_EQ(out.sliding_rms_rad, 0.0);
  EXPECT_EQ(out.mean_square_error_rad2, 0.0);
  EXPECT_EQ(out.window_share, 1.0);
}

// A step of the error by 1 rad: after n ticks the window of 361 holds n of them.
TEST(JointPerformance, FollowsAStepOfTheErrorWithinTheWindow) {
  JointPerformance joint({}, kJointPeriod_s);
  for (std::uint64_t tick = 0; tick < 1000; ++tick) joint.Step(tick, WithError(0.0));
  for (std::uint64_t n = 1; n <= 500; ++n) {
    const JointPerformanceOutput out = joint.Step(999 + n, WithError(-1.0));
    const double in_window = std::min(static_cast<double>(n), 361.0);
    EXPECT_NEAR(out.sliding_rms_rad, std::sqrt(in_window / 361.0), 1e-14);
    EXPECT_NEAR(out.mean_square_error_rad2,
                static_cast<double>(n) / (1000.0 + static_cast<double>(n)), 1e-14);
    EXPECT_EQ(out.error_rad, -1.0);
  }
}

TEST(JointPerformance, OfASineIsItsAmplitudeOverRootTwo) {
  JointPerformance joint({.window_s = 2.0 - kJointPeriod_s}, kJointPeriod_s);  // whole periods
  JointPerformanceOutput out;
  for (std::uint64_t tick = 0; tick < 2400; ++tick) {
    out = joint.Step(tick, WithError(0.3 * std::sin(2.0 * std::numbers::pi *
                                                    static_cast<double>(tick) / 240.0)));
  }
  EXPECT_NEAR(out.sliding_rms_rad, 0.3 / std::sqrt(2.0), 1e-13);
}

// 11.6 h at 240 Hz. Bursts of 10^6 rad pass through the window: a running sum of squares would
// keep 10^12 eps = 10^-4 rad^2 of each.
TEST(JointPerformance, StaysExactOverTenMillionTicks) {
  constexpr std::uint64_t kTicks = 10'000'000;
  constexpr int kWindowTicks = 361;
  // Sums of non-negative addends: (N + 1) eps each for the window and the direct sum.
  constexpr double kTolerance = 2.0 * (kWindowTicks + 1) * std::numeric_limits<double>::epsilon();
  JointPerformance joint({}, kJointPeriod_s);
  std::mt19937_64 random(7);
  std::vector<double> ring(kWindowTicks, 0.0);
  // Small squares and bursts apart: even 64 bits of mantissa cannot add 10^-5 to 10^14.
  long double small = 0.0L, bursts = 0.0L, work = 0.0L;
  double worst = 0.0, last_power = 0.0;
  JointPerformanceOutput out;
  for (std::uint64_t tick = 0; tick < kTicks; ++tick) {
    const double unit = static_cast<double>(random() >> 11) * 0x1p-53;
    double error_rad = 0.01 * (unit - 0.5);
    if (tick % 1'000'003 < 20) error_rad = 1e6;
    const JointSample sample{
        .reference_rad = error_rad, .position_rad = 0.0, .velocity_rad_s = unit, .torque_Nm = 2.0};
    out = joint.Step(tick, sample);
    ring[tick % kWindowTicks] = error_rad * error_rad;
    (error_rad < 1.0 ? small : bursts) += static_cast<long double>(error_rad * error_rad);
    const double power = 2.0 * unit;
    if (tick > 0) work += (0.5L * last_power + 0.5L * power) * kJointPeriod_s;
    last_power = power;
    if (tick < kWindowTicks || tick % 1009 != 0) continue;
    double direct = 0.0;
    for (const double square : ring) direct += square;
    const double expected = std::sqrt(direct / kWindowTicks);
    worst = std::max(worst, std::abs(out.sliding_rms_rad - expected) / expected);
  }
  EXPECT_LT(worst, kTolerance);
  const double mean = static_cast<double>((small + bursts) / kTicks);
  EXPECT_NEAR(out.mean_square_error_rad2 / mean, 1.0, 1e-15);
  EXPECT_NEAR(out.energies.net_J / static_cast<double>(work), 1.0, 1e-15);
  EXPECT_EQ(out.error_samples, kTicks);
  RecordProperty("worst_relative_error", std::to_string(worst * 1e15) + "e-15");
}

TEST(JointPerformance, LeavesLostSamplesOutOfTheWindowAndCountsThem) {
  JointPerformance joint({}, kJointPeriod_s);
  std::uint64_t tick = 0;
  for (; tick < 361; ++tick) joint.Step(tick, WithError(1.0));
  JointSample lost = WithError(1.0);
  lost.position_rad = kNotSampled;
  JointPerformanceOutput out = joint.Step(tick, lost);
  EXPECT_FALSE(out.error_known);
  EXPECT_EQ(out.error_rad, 0.0);
  EXPECT_DOUBLE_EQ(out.sliding_rms_rad, 1.0);
  EXPECT_NEAR(out.window_share, 360.0 / 361.0, 1e-15);
  out = joint.Step(tick + 10, WithError(1.0));  // 9 missing
  EXPECT_EQ(out.error_lost, 10u);
  EXPECT_DOUBLE_EQ(out.sliding_rms_rad, 1.0);
  EXPECT_NEAR(out.window_share, 351.0 / 361.0, 1e-15);
  EXPECT_DOUBLE_EQ(out.mean_square_error_rad2, 1.0);
}

TEST(JointPerformance, KnowsNoRmsWhenTheWholeWindowIsLost) {
  JointPerformance joint({}, kJointPeriod_s);
  joint.Step(0, WithError(1.0));
  const JointPerformanceOutput out = joint.Step(5000, JointSample{});
  EXPECT_FALSE(out.rms_known);
  EXPECT_EQ(out.sliding_rms_rad, 0.0);
  EXPECT_EQ(out.error_samples, 1u);
}

TEST(JointPerformance, GivesNumbersWhateverComes) {
  JointPerformance joint({}, kJointPeriod_s);
  const double inf = std::numeric_limits<double>::infinity();
  std::uint64_t tick = 0;
  for (const double value : {kNotSampled, inf, -inf, 1e308, -1e308, 1e200, 1e-320, 0.0}) {
    const JointSample sample{value, -value, value, value, value};
    const JointPerformanceOutput out = joint.Step(tick++, sample);
    for (const double number :
         {out.error_rad, out.sliding_rms_rad, out.mean_square_error_rad2, out.energies.absolute_J,
          out.energies.positive_J, out.energies.net_J, out.energies.copper_loss_J}) {
      EXPECT_TRUE(std::isfinite(number)) << value;
    }
  }
}

TEST(JointPerformance, LeavesOutAndCountsATickThatIsNotNew) {
  JointPerformance joint({}, kJointPeriod_s);
  joint.Step(7, WithError(0.1));
  joint.Step(7, WithError(5.0));
  const JointPerformanceOutput out = joint.Step(3, WithError(5.0));
  EXPECT_EQ(out.repeated_ticks, 2u);
  EXPECT_EQ(out.error_samples, 1u);
  EXPECT_NEAR(out.sliding_rms_rad, 0.1, 1e-15);
}

TEST(JointPerformance, AllocatesNothingInAStep) {
  JointPerformance joint({}, kJointPeriod_s);
  const long before = test::Allocations();
  for (std::uint64_t tick = 0; tick < 5000; tick += 1 + tick % 3) joint.Step(tick, WithError(0.1));
  EXPECT_EQ(test::Allocations(), before);
}

TEST(JointPerformance, RefusesFiguresOutOfRange) {
  EXPECT_THROW(JointPerformance({}, 0.0), std::invalid_argument);
  EXPECT_THROW(JointPerformance({.window_s = 0.001}, kJointPeriod_s), std::invalid_argument);
  EXPECT_THROW(JointPerformance({.window_s = kNotSampled}, kJointPeriod_s), std::invalid_argument);
  EXPECT_THROW(JointPerformance({.bridge_s = -1.0}, kJointPeriod_s), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::performance
