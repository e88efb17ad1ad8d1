#include "components/record/logger/player/pace.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace sinew::logger {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

TEST(Pace, APositionIsDueAfterItsTimeDividedByTheRate) {
  Pace pace(2.0);
  EXPECT_EQ(pace.DueAt(10 * kSecond_ns, 0), 5 * kSecond_ns);
  EXPECT_EQ(pace.PositionAt(5 * kSecond_ns), 10 * kSecond_ns);
}

TEST(Pace, AtTheMaximumRateEverythingIsDueNow) {
  Pace pace(kMaxRate);
  EXPECT_EQ(pace.DueAt(10 * kSecond_ns, 123), 123);
  EXPECT_EQ(pace.PositionAt(99 * kSecond_ns), 0);
  pace.JumpTo(10 * kSecond_ns, 123);
  EXPECT_EQ(pace.PositionAt(99 * kSecond_ns), 10 * kSecond_ns);
}

TEST(Pace, WhilePausedNothingIsDueAndThePositionStays) {
  Pace pace(1.0);
  pace.Pause(3 * kSecond_ns);
  EXPECT_TRUE(pace.paused());
  EXPECT_EQ(pace.DueAt(0, 9 * kSecond_ns), std::nullopt);
  EXPECT_EQ(pace.PositionAt(9 * kSecond_ns), 3 * kSecond_ns);
  pace.Resume(9 * kSecond_ns);
  EXPECT_EQ(pace.PositionAt(10 * kSecond_ns), 4 * kSecond_ns);
  EXPECT_EQ(pace.DueAt(5 * kSecond_ns, 10 * kSecond_ns), 11 * kSecond_ns);
}

TEST(Pace, AnotherRateBeginsWhereThePlayerIs) {
  Pace pace(1.0);
  pace.SetRate(4.0, 2 * kSecond_ns);
  EXPECT_EQ(pace.PositionAt(2 * kSecond_ns), 2 * kSecond_ns);
  EXPECT_EQ(pace.DueAt(10 * kSecond_ns, 2 * kSecond_ns), 4 * kSecond_ns);
}

TEST(Pace, AJumpBackMakesEarlierPositionsDueAgain) {
  Pace pace(1.0);
  pace.JumpTo(kSecond_ns, 50 * kSecond_ns);
  EXPECT_EQ(pace.DueAt(kSecond_ns, 50 * kSecond_ns), 50 * kSecond_ns);
  EXPECT_EQ(pace.DueAt(2 * kSecond_ns, 50 * kSecond_ns), 51 * kSecond_ns);
}

TEST(Pace, ADayAtTheLeastRateIsExactToAMicrosecond) {
  const Pace pace(kLeastRate);
  const std::int64_t day_ns = 86'400 * kSecond_ns;
  EXPECT_NEAR(static_cast<double>(*pace.DueAt(day_ns, 0) - 10 * day_ns), 0.0, 1e3);
}

TEST(Pace, RefusesRatesThatAreNone) {
  for (const double rate : {0.05, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(Pace{rate}, std::invalid_argument) << rate;
    Pace pace(2.0);
    EXPECT_THROW(pace.SetRate(rate, 0), std::invalid_argument) << rate;
    EXPECT_EQ(pace.rate(), 2.0);
  }
}

}  // namespace
}  // namespace sinew::logger
