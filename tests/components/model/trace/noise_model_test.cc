#include "components/model/trace/noise_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace sinew::trace {
namespace {

Eigen::VectorXd White(Eigen::Index count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Eigen::VectorXd out(count);
  for (double& value : out) value = normal(random);
  return out;
}

// x_t = 0.8 x_{t-1} - 0.3 x_{t-2} + 2 e_t
Eigen::VectorXd Coloured(Eigen::Index count, unsigned seed) {
  const Eigen::VectorXd e = White(count, seed);
  Eigen::VectorXd out(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    out[i] = 2.0 * e[i] + (i > 0 ? 0.8 * out[i - 1] : 0.0) - (i > 1 ? 0.3 * out[i - 2] : 0.0);
  }
  return out;
}

const std::vector<Stretch> kStretches = {{0, 4000}, {4000, 7}, {4007, 1}, {4008, 15992}};
constexpr Eigen::Index kRows = 20000;

double LagOne(const Eigen::VectorXd& x) {
  const Eigen::Index n = x.size();
  return x.head(n - 1).dot(x.tail(n - 1)) / x.squaredNorm();
}

TEST(NoiseModel, WhitensAnAutoregressiveProcessToUnitVariance) {
  const Eigen::VectorXd x = Coloured(kRows, 1);
  const NoiseModel model(x, kStretches, 12);
  EXPECT_GE(model.order(), 2);
  // The white floor, 1 % of the variance, makes the innovation a little larger than the true 2.
  EXPECT_NEAR(model.sigma(), 2.0, 0.1);
  const Eigen::VectorXd e = model.Whiten(x, kStretches);
  EXPECT_NEAR(e.squaredNorm() / kRows, 1.0, 0.05);
  EXPECT_NEAR(LagOne(e), 0.0, 0.05);
}

TEST(NoiseModel, FirstRowsOfAStretchHaveTheSameVarianceAsTheRest) {
  const NoiseModel model(Coloured(kRows, 1), kStretches, 12);
  double sum = 0.0;
  constexpr int kTrials = 4000;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Eigen::VectorXd x = Coloured(60, 100 + static_cast<unsigned>(trial)).tail(3);
    const double first = model.Whiten(x, {{0, 3}})(0, 0);
    sum += first * first;
  }
  EXPECT_NEAR(sum / kTrials, 1.0, 0.15);
}

TEST(NoiseModel, TransposedFilterGivesTheSameInnerProducts) {
  const NoiseModel model(Coloured(kRows, 1), kStretches, 12);
  const Eigen::VectorXd x = White(kRows, 2), e = White(kRows, 3);
  const double direct = e.dot(Eigen::VectorXd(model.Whiten(x, kStretches)));
  const double transposed = model.Transpose(e, kStretches).dot(x);
  EXPECT_NEAR(direct, transposed, 1e-9 * e.norm() * x.norm());
}

TEST(NoiseModel, StretchesDoNotSeeEachOther) {
  const NoiseModel model(Coloured(kRows, 1), kStretches, 12);
  Eigen::VectorXd x = White(100, 4);
  const Eigen::VectorXd before = model.Whiten(x, {{0, 50}, {50, 50}});
  x.head(50).setZero();
  const Eigen::VectorXd after = model.Whiten(x, {{0, 50}, {50, 50}});
  EXPECT_EQ(before.tail(50), after.tail(50));
}

TEST(NoiseModel, ABandWithoutNoiseIsNotAmplifiedWithoutBound) {
  // Every tenth row measured, the rest interpolated: nothing above a tenth of the Nyquist
  // frequency.
  const Eigen::VectorXd coarse = White(kRows / 10 + 1, 5);
  Eigen::VectorXd x(kRows);
  for (Eigen::Index i = 0; i < kRows; ++i) {
    const double part = static_cast<double>(i % 10) / 10.0;
    x[i] = (1.0 - part) * coarse[i / 10] + part * coarse[i / 10 + 1];
  }
  const NoiseModel model(x, {{0, kRows}}, 20);
  // The filter's gain for white rows of the process' own size: at most 1 / sqrt(1 %) and what the
  // stop band's slopes add.
  const Eigen::VectorXd white = std::sqrt(x.squaredNorm() / kRows) * White(kRows, 6);
  const Eigen::VectorXd e = model.Whiten(white, {{0, kRows}});
  EXPECT_LT(std::sqrt(e.squaredNorm() / kRows), 30.0);
}

TEST(NoiseModel, NoRowsGiveNoNoise) {
  const NoiseModel model(Eigen::VectorXd(), {}, 5);
  EXPECT_EQ(model.order(), 0);
  EXPECT_TRUE(std::isfinite(model.sigma()));
}

}  // namespace
}  // namespace sinew::trace
