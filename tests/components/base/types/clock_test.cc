#include "components/base/types/clock/clock.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdint>
#include <regex>

#include "components/base/types/angle.h"
#include "components/base/types/clock/utc.h"

namespace sinew::types {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

// Expected texts from `date --utc --iso-8601=seconds --date=@SECONDS`.
TEST(UtcText, WritesTheSecondThatTheInstantBelongsTo) {
  EXPECT_EQ(UtcText(0), "1970-01-01T00:00:00Z");
  EXPECT_EQ(UtcText(kSecond_ns - 1), "1970-01-01T00:00:00Z");
  EXPECT_EQ(UtcText(kSecond_ns), "1970-01-01T00:00:01Z");
  EXPECT_EQ(UtcText(1'000'000'000 * kSecond_ns), "2001-09-09T01:46:40Z");
  EXPECT_EQ(UtcText(1'709'210'096 * kSecond_ns + 999'999'999), "2024-02-29T12:34:56Z");
}

TEST(UtcText, WritesInstantsBeforeTheEpoch) {
  EXPECT_EQ(UtcText(-1), "1969-12-31T23:59:59Z");
  EXPECT_EQ(UtcText(-kSecond_ns), "1969-12-31T23:59:59Z");
  EXPECT_EQ(UtcText(-kSecond_ns - 1), "1969-12-31T23:59:58Z");
}

TEST(UtcNow, LiesBetweenTwoReadingsOfTheClock) {
  const std::string before = UtcText(EpochNow_ns());
  const std::string now = UtcNow();
  const std::string after = UtcText(EpochNow_ns());
  // Texts of this form sort by time.
  EXPECT_TRUE(std::regex_match(now, std::regex(R"(\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ)"))) << now;
  EXPECT_LE(before, now);
  EXPECT_LE(now, after);
}

TEST(EpochNow, IsTheSystemClock) {
  const auto system_ns = [] {
    return std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
  };
  const std::int64_t before = system_ns();
  const std::int64_t now = EpochNow_ns();
  EXPECT_LE(before, now);
  EXPECT_LE(now, system_ns());
}

TEST(MonotonicNow, IsTheSteadyClockAndNeverGoesBack) {
  const auto steady_ns = [] {
    return std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
  };
  std::int64_t last = steady_ns();
  for (int i = 0; i < 1000; ++i) {
    const std::int64_t now = MonotonicNow_ns();
    ASSERT_LE(last, now);
    last = now;
  }
  EXPECT_LE(last, steady_ns());
}

TEST(Angle, ConstantsAreThoseOfTheCircle) {
  EXPECT_EQ(std::atan2(0.0, -1.0), kPi);
  EXPECT_EQ(kTwoPi, 2.0 * kPi);
  EXPECT_DOUBLE_EQ(360.0 * kDegree_rad, kTwoPi);
}

}  // namespace
}  // namespace sinew::types
