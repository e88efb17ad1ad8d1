#include "components/base/types/seconds.h"

#include <gtest/gtest.h>

#include <limits>

namespace sinew::types {
namespace {

using namespace std::chrono_literals;

TEST(Seconds, AreRoundedToNanoseconds) {
  EXPECT_EQ(ToNanoseconds(0.0), 0ns);
  EXPECT_EQ(ToNanoseconds(0.1), 100ms);
  EXPECT_EQ(ToNanoseconds(-1.6e-9), -2ns);
  EXPECT_EQ(ToNanoseconds(kLongest_s), 36525 * 24h);
}

TEST(Seconds, BeyondACenturyAreRefused) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double bad :
       {1e300, -1e300, 3.2e9, kInfinity, -kInfinity, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(ToNanoseconds(bad), std::invalid_argument) << bad;
  }
  try {
    ToNanoseconds(1e300);
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "a time of 1e+300 s, expected at most 3155760000 s (a century)");
  }
}

TEST(SecondsText, KeepsTheDigitsOfAStamp) {
  EXPECT_EQ(SecondsText(0.0), "0");
  EXPECT_EQ(SecondsText(12.5), "12.5");
  EXPECT_EQ(SecondsText(100.0), "100");
  EXPECT_EQ(SecondsText(1716900000.25), "1716900000.25");
  EXPECT_EQ(SecondsText(-0.0625), "-0.062");
}

}  // namespace
}  // namespace sinew::types
