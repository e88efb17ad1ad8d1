// Oracle: the test itself on random values.
#include "components/robot/residual/run_length.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

namespace sinew::residual {
namespace {

// Values until the largest |sum of the last n| / sqrt(n), n = 1 .. window, passes the threshold.
long RunLength(double threshold, int window, std::mt19937_64* random) {
  std::normal_distribution<double> normal;
  std::vector<double> ring(static_cast<std::size_t>(window), 0.0);
  for (long t = 1;; ++t) {
    ring[static_cast<std::size_t>(t % window)] = normal(*random);
    double sum = 0.0;
    for (int n = 1; n <= std::min<long>(window, t); ++n) {
      sum += ring[static_cast<std::size_t>((t - n + 1) % window)];
      if (std::abs(sum) > threshold * std::sqrt(static_cast<double>(n))) return t;
    }
  }
}

TEST(RunLength, IsThatOfTheTestItself) {
  std::mt19937_64 random(5);
  for (const auto& [threshold, window] : {std::pair{3.6, 40}, std::pair{4.0, 10}}) {
    constexpr int kRuns = 400;  // standard error 5 %
    double sum = 0.0;
    for (int i = 0; i < kRuns; ++i)
      sum += static_cast<double>(RunLength(threshold, window, &random));
    const double measured = sum / kRuns;
    EXPECT_NEAR(MeanRunLength(threshold, window) / measured, 1.0, 0.25)
        << threshold << " " << window << ": " << measured;
  }
}

TEST(RunLength, ThresholdIsItsInverseAndRisesWithStatistics) {
  for (const double length : {1e3, 1e6, 3e8}) {
    EXPECT_NEAR(MeanRunLength(ThresholdFor(length, 40, 1), 40) / length, 1.0, 1e-6) << length;
    EXPECT_NEAR(MeanRunLength(ThresholdFor(length, 40, 6), 40) / length, 6.0, 1e-5) << length;
  }
}

TEST(RunLength, RefusesWhatCannotBe) {
  EXPECT_THROW(static_cast<void>(ThresholdFor(1.0, 40, 1)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(ThresholdFor(NAN, 40, 1)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(ThresholdFor(1e3, 40, 0)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(MeanRunLength(0.5, 40)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(MeanRunLength(4.0, 0)), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::residual
