#include "components/identify/statistics.h"

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
  // scipy.stats.t.cdf(1.7, 7), cdf(-3, 2.5)
  EXPECT_NEAR(StudentCdf(1.7, 7), 0.9335355516087225, 1e-12);
  EXPECT_NEAR(StudentCdf(-3.0, 2.5), 0.036288047774515914, 1e-12);
}

TEST(Statistics, StudentIsSymmetricAndHalfAtZero) {
  EXPECT_DOUBLE_EQ(StudentCdf(0.0, 4.0), 0.5);
  for (const double t : {0.1, 1.0, 5.0}) {
    EXPECT_NEAR(StudentCdf(t, 9.0) + StudentCdf(-t, 9.0), 1.0, 1e-14);
  }
  EXPECT_TRUE(std::isnan(StudentQuantile(1.0, 4.0)));
}

TEST(Statistics, QuantilesLieBetweenOrderStatistics) {
  EXPECT_DOUBLE_EQ(Quantile({3.0, 1.0, 2.0}, 0.5), 2.0);
  EXPECT_DOUBLE_EQ(Quantile({0.0, 10.0}, 0.25), 2.5);
  EXPECT_DOUBLE_EQ(Quantile({}, 0.5), 0.0);
}

TEST(Statistics, CorrelationTimeOfAnAutoregressionIsItsClosedForm) {
  // x[i] = r x[i-1] + e: 1 + 2 sum r^k = (1 + r) / (1 - r) = 9 for r = 0.8.
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  const int n = 100000;
  Eigen::VectorXd x(n);
  double state = 0.0;
  for (double& value : x) value = state = 0.8 * state + normal(random);
  const std::vector<char> used(n, 1);
  const std::vector<int> segment(n, 0);
  const Eigen::VectorXd rho = Autocorrelation(x, used, segment, 200);
  EXPECT_NEAR(rho[0], 1.0, 1e-12);
  EXPECT_NEAR(rho[1], 0.8, 0.01);
  EXPECT_NEAR(CorrelationTime(rho), 9.0, 0.6);  // standard error about 0.3
}

TEST(Statistics, CorrelationsDoNotCrossSegmentsOrUnusedRows) {
  Eigen::VectorXd x(4);
  x << 1.0, 1.0, -1.0, -1.0;
  EXPECT_DOUBLE_EQ(Autocorrelation(x, {1, 1, 1, 1}, {0, 0, 1, 1}, 1)[1], 1.0);
  EXPECT_DOUBLE_EQ(Autocorrelation(x, {1, 0, 1, 1}, {0, 0, 0, 0}, 1)[1], 1.0);
}

TEST(Statistics, NoPowerMeansNoCorrelation) {
  const Eigen::VectorXd rho =
      Autocorrelation(Eigen::VectorXd::Zero(5), {1, 1, 1, 1, 1}, {0, 0, 0, 0, 0}, 2);
  EXPECT_EQ(rho.cwiseAbs().maxCoeff(), 0.0);
  EXPECT_DOUBLE_EQ(CorrelationTime(rho), 1.0);
}

}  // namespace
}  // namespace sinew::identify
