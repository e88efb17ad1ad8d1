#include "components/topics/node/tick_period.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

namespace sinew::node {
namespace {

constexpr double kNominal_s = 0.004;
constexpr std::int64_t kNominal_ns = 4'000'000;
constexpr std::int64_t kStart_ns = 1'700'000'000'000'000'000;  // epoch time of a live robot
constexpr bool kLive = false, kSimulated = true;
// Nanoseconds as doubles of seconds: the difference is exact, its product rounds once.
constexpr double kRounding_s = 1e-15;

// Feeds cycles of one session: the tick, and how long after the last one it was measured.
class Cycles {
 public:
  explicit Cycles(bool simulated) : simulated_(simulated) {}
  double Next(std::uint64_t ticks, std::int64_t elapsed_ns) {
    tick_ += ticks;
    stamp_ns_ += elapsed_ns;
    return period_.Next(session, tick_, stamp_ns_, simulated_, kNominal_s);
  }
  std::uint64_t session = 9;

 private:
  const bool simulated_;
  TickPeriod period_;
  std::uint64_t tick_ = 100;
  std::int64_t stamp_ns_ = kStart_ns;
};

TEST(TickPeriod, IsNominalAtTheFirstTickOfASession) {
  Cycles cycles(kLive);
  EXPECT_EQ(cycles.Next(1, 7 * kNominal_ns), kNominal_s);
  EXPECT_NEAR(cycles.Next(1, kNominal_ns + 1000), kNominal_s + 1e-6, kRounding_s);
  cycles.session = 10;
  EXPECT_EQ(cycles.Next(1, kNominal_ns + 1000), kNominal_s);
}

TEST(TickPeriod, IsTheDifferenceOfTheStamps) {
  Cycles cycles(kLive);
  cycles.Next(1, 0);
  double sum_s = 0.0;
  std::int64_t sum_ns = 0;
  for (int i = 0; i < 100000; ++i) {
    const std::int64_t elapsed_ns = kNominal_ns + (i * 7919) % 1'000'001 - 500'000;
    sum_ns += elapsed_ns;
    const double period_s = cycles.Next(1, elapsed_ns);
    ASSERT_NEAR(period_s, static_cast<double>(elapsed_ns) * 1e-9, kRounding_s);
    sum_s += period_s;
  }
  EXPECT_NEAR(sum_s, static_cast<double>(sum_ns) * 1e-9, 1e-9);
}

TEST(TickPeriod, CountsAGapUpToFourPeriods) {
  Cycles cycles(kLive);
  cycles.Next(1, 0);
  EXPECT_NEAR(cycles.Next(3, 3 * kNominal_ns), 3 * kNominal_s, kRounding_s);
  EXPECT_NEAR(cycles.Next(4, 4 * kNominal_ns), 4 * kNominal_s, kRounding_s);
  EXPECT_EQ(cycles.Next(5, 5 * kNominal_ns), TickPeriod::kLongestPeriods * kNominal_s);
  EXPECT_EQ(cycles.Next(1, 3'600'000'000'000), TickPeriod::kLongestPeriods * kNominal_s)
      << "the clock was set forward";
  EXPECT_NEAR(cycles.Next(1, kNominal_ns), kNominal_s, kRounding_s) << "and is forgotten";
}

TEST(TickPeriod, IsNeverBelowHalfAPeriod) {
  Cycles cycles(kLive);
  cycles.Next(1, 0);
  EXPECT_EQ(cycles.Next(1, 1), TickPeriod::kShortestPeriods * kNominal_s);
  EXPECT_NEAR(cycles.Next(1, 2'100'000), 0.0021, kRounding_s);
}

TEST(TickPeriod, IsNominalWhereTheStampDoesNotAdvance) {
  Cycles cycles(kLive);
  cycles.Next(1, 0);
  EXPECT_EQ(cycles.Next(1, 0), kNominal_s);
  EXPECT_EQ(cycles.Next(1, -3'600'000'000'000), kNominal_s) << "the clock was set back";
}

TEST(TickPeriod, OfASimulatedRobotCountsTicksNotTheClock) {
  Cycles cycles(kSimulated);
  cycles.Next(1, 0);
  EXPECT_EQ(cycles.Next(1, 2 * kNominal_ns), kNominal_s);
  EXPECT_EQ(cycles.Next(3, kNominal_ns), 3 * kNominal_s);
  EXPECT_EQ(cycles.Next(50, kNominal_ns), TickPeriod::kLongestPeriods * kNominal_s);
}

TEST(TickPeriod, StaysInItsRangeForAnyStamps) {
  TickPeriod period;
  const std::int64_t stamps[] = {std::numeric_limits<std::int64_t>::min(), 0, kStart_ns, -1,
                                 std::numeric_limits<std::int64_t>::max()};
  for (const std::int64_t a : stamps) {
    for (const std::int64_t b : stamps) {
      period.Next(1, 0, a, kLive, kNominal_s);
      const double period_s = period.Next(1, 1, b, kLive, kNominal_s);
      EXPECT_GE(period_s, TickPeriod::kShortestPeriods * kNominal_s) << a << ' ' << b;
      EXPECT_LE(period_s, TickPeriod::kLongestPeriods * kNominal_s) << a << ' ' << b;
    }
  }
}

TEST(TickPeriod, ReturnsANominalPeriodThatIsNotPositive) {
  TickPeriod period;
  period.Next(1, 0, 0, kLive, kNominal_s);
  EXPECT_EQ(period.Next(1, 1, kNominal_ns, kLive, 0.0), 0.0);
  EXPECT_EQ(period.Next(1, 2, 2 * kNominal_ns, kLive, -1.0), -1.0);
}

}  // namespace
}  // namespace sinew::node
