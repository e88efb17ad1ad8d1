#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <stdexcept>

#include "components/base/simd/fastest.h"
#include "components/base/simd/instructions.h"
#include "components/base/simd/lanes.h"  // for the instruction set of this file: the portable one

namespace {

using sinew::simd::Fastest;
using sinew::simd::Instructions;
using sinew::simd::kAllInstructions;
using sinew::simd::kFastestRounds;
using sinew::simd::RequireRuns;
using sinew::simd::Runs;

TEST(Instructions, ThePortableSetRunsEverywhere) {
  EXPECT_TRUE(Runs(Instructions::kPortable));
  EXPECT_NO_THROW(RequireRuns(Instructions::kPortable));
  EXPECT_STREQ(sinew::simd::Name(Instructions::kAvx2), "AVX2");
}

TEST(Instructions, ASetThatDoesNotRunHereIsNamed) {
  const auto none = static_cast<Instructions>(17);
  EXPECT_FALSE(Runs(none));
  EXPECT_THROW(RequireRuns(none), std::invalid_argument);
}

// Every set in turn is made the fastest: the others do a thousand times its work.
TEST(Fastest, TheSetWithTheLeastTimeIsTaken) {
  for (const Instructions fast : kAllInstructions) {
    if (!Runs(fast)) continue;
    volatile double sum = 0.0;
    const auto work = [&](Instructions set) {
      const int count = set == fast ? 100 : 100'000;
      for (int i = 0; i < count; ++i) sum = sum + 1.0;
    };
    EXPECT_EQ(Fastest(work), fast) << sinew::simd::Name(fast);
  }
}

TEST(Fastest, EverySetThatRunsHereIsRunEquallyOften) {
  std::map<Instructions, int> runs;
  Fastest([&](Instructions set) { ++runs[set]; });
  for (const Instructions set : kAllInstructions) {
    EXPECT_EQ(runs[set], Runs(set) ? kFastestRounds : 0) << sinew::simd::Name(set);
  }
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();
const double kA[8] = {1.5, -2.0, 0.0, -0.0, 1e300, -1e-300, std::nan(""), kInfinity};
const double kB[8] = {0.5, 3.0, -0.0, 7.0, -1e300, 1e-310, 1.0, -kInfinity};

bool SameBits(double a, double b) {
  return std::memcmp(&a, &b, sizeof a) == 0 || (std::isnan(a) && std::isnan(b));
}

template <class Lane, class Scalar>
void ExpectLanewise(Lane lane, Scalar scalar) {
  double result[8];
  Store(result, lane(Load(kA), Load(kB)));
  for (int i = 0; i < 8; ++i)
    EXPECT_TRUE(SameBits(result[i], scalar(kA[i], kB[i]))) << i << ": " << result[i];
}

TEST(Lanes, ArithmeticIsThatOfDoubles) {
  ExpectLanewise([](Lanes a, Lanes b) { return a + b; }, [](double a, double b) { return a + b; });
  ExpectLanewise([](Lanes a, Lanes b) { return a - b; }, [](double a, double b) { return a - b; });
  ExpectLanewise([](Lanes a, Lanes b) { return a * b; }, [](double a, double b) { return a * b; });
  ExpectLanewise([](Lanes a, Lanes b) { return a / b; }, [](double a, double b) { return a / b; });
  ExpectLanewise([](Lanes a, Lanes b) { return Min(a, b); },
                 [](double a, double b) { return a < b ? a : b; });
  ExpectLanewise([](Lanes a, Lanes) { return Abs(a); },
                 [](double a, double) { return std::abs(a); });
  ExpectLanewise([](Lanes a, Lanes b) { return WithSignOf(Abs(a), b); },
                 [](double a, double b) { return std::copysign(std::abs(a), b); });
  ExpectLanewise([](Lanes, Lanes) { return Broadcast(2.5); }, [](double, double) { return 2.5; });
}

TEST(Lanes, GathersByIndex) {
  const double table[5] = {10.0, 11.0, 12.0, 13.0, 14.0};
  const std::int32_t index[8] = {4, 0, 3, 3, 1, 2, 0, 4};
  double result[8];
  Store(result, Gather(table, index));
  for (int i = 0; i < 8; ++i) EXPECT_EQ(result[i], table[index[i]]);
}

TEST(Lanes, PowersOfTwoAreExact) {
  for (const int n : {-60, -1, 0, 1, 57}) {
    double result[8];
    Store(result, PowerOfTwo(Broadcast(n) + Broadcast(kShift)));
    EXPECT_EQ(result[0], std::ldexp(1.0, n));
    EXPECT_EQ(result[7], std::ldexp(1.0, n));
  }
}

TEST(Lanes, SumsInPairs) {
  const double v[8] = {1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.5};
  EXPECT_EQ(Sum(Load(v)), 36.5);
}

}  // namespace
