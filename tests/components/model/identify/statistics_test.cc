#include "components/model/identify/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace sinew::identify {
namespace {

TEST(Statistics, StudentQuantilesAgreeWithSciPy) {
  // scipy 1.10: scipy.stats.t.ppf(0.975, [1, 5, 30, 200])
  EXPECT_NEAR(StudentQuantile(0.975, 1), 12.706204736432095, 1e-9);
  EXPECT_NEAR(StudentQuantile(0.975, 5), 2.5705818366147395, 2e-9);  // tables say 2.570581836
  EXPECT_NEAR(StudentQuantile(0.975, 30), 2.0422724563012373, 1e-10);
  EXPECT_NEAR(StudentQuantile(0.975, 200), 1.9718962236316089, 1e-10);
  // Shares from scipy.stats.t.cdf(1.7, 7), cdf(-3, 2.5)
  EXPECT_NEAR(StudentQuantile(0.9335355516087225, 7), 1.7, 1e-12);
  EXPECT_NEAR(StudentQuantile(0.036288047774515914, 2.5), -3.0, 1e-12);
}

TEST(Statistics, StudentIsSymmetricAndZeroAtHalf) {
  EXPECT_EQ(StudentQuantile(0.5, 4.0), 0.0);
  for (const double p : {0.6, 0.9, 0.999}) {
    EXPECT_NEAR(StudentQuantile(p, 9.0) + StudentQuantile(1.0 - p, 9.0), 0.0, 1e-12);
  }
}

TEST(Statistics, StudentQuantilesOfImpossibleArgumentsAreNotANumber) {
  for (const double p : {0.0, 1.0, -0.1, std::nan("")}) {
    EXPECT_TRUE(std::isnan(StudentQuantile(p, 4.0))) << p;
  }
  EXPECT_TRUE(std::isnan(StudentQuantile(0.9, 0.0)));
}

TEST(Statistics, QuantilesLieBetweenOrderStatistics) {
  EXPECT_DOUBLE_EQ(Quantile({3.0, 1.0, 2.0}, 0.5), 2.0);
  EXPECT_DOUBLE_EQ(Quantile({0.0, 10.0}, 0.25), 2.5);
  EXPECT_DOUBLE_EQ(Quantile({}, 0.5), 0.0);
}

TEST(Statistics, ResolutionIsTheStepOfWhichDifferencesAreWholeMultiples) {
  Eigen::VectorXd counts(200), smooth(200);
  for (Eigen::Index i = 0; i < 200; ++i) {
    smooth[i] = std::sin(0.05 * static_cast<double>(i));
    counts[i] = 0.01 * std::round(smooth[i] / 0.01);
  }
  EXPECT_NEAR(Resolution(counts), 0.01, 1e-12);
  EXPECT_EQ(Resolution(smooth), 0.0);
  EXPECT_EQ(Resolution(Eigen::VectorXd::Constant(50, 3.0)), 0.0);
}

}  // namespace
}  // namespace sinew::identify
