// The window against a direct sum of what it holds.
#include "components/robot/performance/sliding_window.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <limits>
#include <optional>
#include <random>
#include <stdexcept>

namespace sinew::performance {
namespace {

constexpr double kLostValue = std::numeric_limits<double>::quiet_NaN();

WindowSum Direct(const std::deque<std::optional<double>>& window) {
  WindowSum sum;
  for (const auto& value : window) {
    if (!value) continue;
    sum.sum += *value;
    sum.smallest = std::min(sum.smallest, *value);
    sum.largest = std::max(sum.largest, *value);
    ++sum.count;
  }
  return sum;
}

TEST(SlidingWindow, EqualsTheDirectSumAtEverySizeWithSamplesLost) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  for (const int size : {1, 2, 3, 7, 64}) {
    SlidingWindow window(size);
    std::deque<std::optional<double>> kept;
    for (int i = 0; i < 5 * size + 20; ++i) {
      const bool lost = random() % 4 == 0;
      const double value = normal(random);
      window.Push(lost ? kLostValue : value);
      kept.push_back(lost ? std::nullopt : std::optional<double>(value));
      if (kept.size() > static_cast<std::size_t>(size)) kept.pop_front();
      const WindowSum expected = Direct(kept), got = window.Sum();
      ASSERT_EQ(got.count, expected.count) << size << " " << i;
      ASSERT_NEAR(got.sum, expected.sum, 1e-14 * size) << size << " " << i;
      ASSERT_EQ(got.smallest, expected.smallest) << size << " " << i;
      ASSERT_EQ(got.largest, expected.largest) << size << " " << i;
    }
  }
}

TEST(SlidingWindow, KeepsNothingOfAHugeValueThatHasLeft) {
  SlidingWindow window(10);
  window.Push(1e30);
  for (int i = 0; i < 10; ++i) window.Push(0.1);
  EXPECT_DOUBLE_EQ(window.Sum().sum, 1.0);
}

TEST(SlidingWindow, IsEmptyAfterALossAsLongAsItself) {
  SlidingWindow window(5);
  for (int i = 0; i < 8; ++i) window.Push(1.0);
  window.PushLost(3);
  EXPECT_EQ(window.Sum().count, 2);
  window.PushLost(5);
  EXPECT_EQ(window.Sum().count, 0);
  window.Push(2.0);
  window.PushLost(std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(window.Sum().count, 0);
}

TEST(SlidingWindow, TakesNoValueThatIsNotUsable) {
  SlidingWindow window(3);
  const double inf = std::numeric_limits<double>::infinity();
  for (const double value : {kLostValue, inf, -inf, 1e151}) window.Push(value);
  EXPECT_EQ(window.Sum().count, 0);
  EXPECT_EQ(window.Sum().sum, 0.0);
}

TEST(SlidingWindow, RefusesASizeOfZero) { EXPECT_THROW(SlidingWindow(0), std::invalid_argument); }

TEST(SlidingWindow, ATimeThatIsAWholeNumberOfPeriodsIsThatNumber) {
  EXPECT_EQ(TicksOf(1.5, 1.0 / 240.0), 360);
  EXPECT_EQ(TicksOf(0.3, 0.1), 3);  // 0.3 / 0.1 < 3 in floating point
  EXPECT_EQ(TicksOf(0.29, 0.1), 2);
  EXPECT_THROW(TicksOf(1.0, 0.0), std::invalid_argument);
  EXPECT_THROW(TicksOf(-1.0, 0.1), std::invalid_argument);
  EXPECT_THROW(TicksOf(kLostValue, 0.1), std::invalid_argument);
  EXPECT_THROW(TicksOf(1e9, 1e-3), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::performance
