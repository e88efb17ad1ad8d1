// Oracles: closed forms, and the frequency with which intervals hold a truth that was put in.
#include "components/model/experiment/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

namespace sinew::experiment {
namespace {

TEST(Statistics, MeanOfTrialsIsStudentsInterval) {
  // Mean 2, standard deviation 1, n = 3: t(0.975, 2) = 4.30265.
  const Estimate estimate = MeanOfTrials({1.0, 2.0, 3.0});
  EXPECT_DOUBLE_EQ(estimate.value, 2.0);
  EXPECT_NEAR(estimate.half_width_95, 4.30265 / std::sqrt(3.0), 1e-4);
  EXPECT_TRUE(estimate.Covers(4.4));
  EXPECT_FALSE(estimate.Covers(4.6));
}

TEST(Statistics, OneTrialHasNoInterval) {
  EXPECT_THROW((void)MeanOfTrials({1.0}), std::invalid_argument);
}

TEST(Statistics, FitOfExactRowsIsExactWhateverTheColumnsSizes) {
  Eigen::MatrixXd X(6, 2);
  Eigen::VectorXd y(6);
  std::vector<int> trial;
  for (int i = 0; i < 6; ++i) {
    X.row(i) << 1e-5 * i, 1e4 * (i % 2);
    y(i) = 3e5 * X(i, 0) - 2e-4 * X(i, 1);
    trial.push_back(i);
  }
  const TrialFit fit = FitTrials(X, X, y, trial);
  constexpr double kRidge = 1e-7;  // relative: the solver's own 1e-9, amplified by correlation
  EXPECT_NEAR(fit.b(0), 3e5, 3e5 * kRidge);
  EXPECT_NEAR(fit.b(1), -2e-4, 2e-4 * kRidge);
}

TEST(Statistics, IntervalsHoldTheTruthWhereRowsOfATrialShareAnError) {
  // 30 trials of 20 rows; half of the noise belongs to the trial. Counting rows as independent
  // would cover in about half of the seeds.
  std::mt19937 random(7);
  std::normal_distribution<double> gauss;
  int covered = 0;
  constexpr int kSeeds = 300;
  for (int seed = 0; seed < kSeeds; ++seed) {
    Eigen::MatrixXd X(600, 2);
    Eigen::VectorXd y(600);
    std::vector<int> trial;
    for (int t = 0; t < 30; ++t) {
      const double slope = gauss(random), shared = gauss(random);
      for (int k = 0; k < 20; ++k) {
        const int i = 20 * t + k;
        X.row(i) << 1.0, slope;
        y(i) = 0.5 + 2.0 * slope + shared + gauss(random);
        trial.push_back(t);
      }
    }
    covered += FitTrials(X, X, y, trial).At(1).Covers(2.0) ? 1 : 0;
  }
  EXPECT_GE(covered, 0.90 * kSeeds);
  EXPECT_LE(covered, 0.99 * kSeeds);
}

TEST(Statistics, IntervalsHoldTheTruthOfFewTrialsOfUnequalWeight) {
  // 12 trials, the last far out: the usual sandwich covers here in 85 of 100 seeds.
  std::mt19937 random(9);
  std::normal_distribution<double> gauss;
  int covered = 0;
  constexpr int kSeeds = 500;
  for (int seed = 0; seed < kSeeds; ++seed) {
    Eigen::MatrixXd X(12, 2);
    Eigen::VectorXd y(12);
    std::vector<int> trial;
    for (int i = 0; i < 12; ++i) {
      X.row(i) << 1.0, i < 11 ? 0.1 * i : 4.0;
      y(i) = 1.0 + 2.0 * X(i, 1) + gauss(random);
      trial.push_back(i);
    }
    covered += FitTrials(X, X, y, trial).At(1).Covers(2.0) ? 1 : 0;
  }
  EXPECT_GE(covered, 0.90 * kSeeds);
}

TEST(Statistics, InstrumentsRemoveTheBiasOfANoisyColumn) {
  std::mt19937 random(3);
  std::normal_distribution<double> gauss;
  constexpr int kRows = 4000;
  Eigen::MatrixXd X(kRows, 1), Z(kRows, 1);
  Eigen::VectorXd y(kRows);
  std::vector<int> trial;
  for (int i = 0; i < kRows; ++i) {
    const double x = gauss(random);
    X(i, 0) = x + 0.5 * gauss(random);
    Z(i, 0) = x + 0.5 * gauss(random);
    y(i) = 2.0 * x + 0.1 * gauss(random);
    trial.push_back(i / 10);
  }
  const TrialFit plain = FitTrials(X, X, y, trial), instrumented = FitTrials(X, Z, y, trial);
  EXPECT_NEAR(plain.b(0), 2.0 / 1.25, 0.05);  // attenuated by the share of noise
  EXPECT_TRUE(instrumented.At(0).Covers(2.0)) << instrumented.b(0);
  EXPECT_LT(instrumented.At(0).half_width_95, 0.1);
}

TEST(Statistics, RoundingLeavesAtMostWhatIsSaid) {
  // Means of many rounded rows of a value that stands still, over phases of the count.
  std::mt19937 random(5);
  constexpr int kRows = 400000;
  for (const double sigma : {0.15, 0.3, 0.4}) {  // of a count
    std::normal_distribution<double> gauss(0.0, sigma);
    double largest = 0.0, variance = 0.0;
    for (const double phase : {0.15, 0.25, 0.35}) {
      double sum = 0.0, sum2 = 0.0;
      for (int i = 0; i < kRows; ++i) {
        const double seen = std::round(phase + gauss(random));
        sum += seen;
        sum2 += seen * seen;
      }
      variance += (sum2 / kRows - sum / kRows * (sum / kRows)) / 3.0;
      largest = std::max(largest, std::abs(sum / kRows - phase));
    }
    const double said = 1.0 / std::numbers::pi *
                        std::exp(-2.0 * std::numbers::pi * std::numbers::pi * sigma * sigma);
    EXPECT_NEAR(largest, said, 0.1 * said + 4.0 * sigma / std::sqrt(kRows)) << sigma;
    // Sheppard's correction is itself an average over phases.
    if (sigma >= 0.3) {
      EXPECT_NEAR(LargestRounding(variance, 1.0), said, 0.35 * said);
    }
  }
}

TEST(Statistics, TooFewTrialsAreRefused) {
  const Eigen::MatrixXd X = Eigen::MatrixXd::Ones(4, 2);
  EXPECT_THROW((void)FitTrials(X, X, Eigen::VectorXd::Ones(4), {0, 0, 1, 1}),
               std::invalid_argument);
}

TEST(Statistics, SlopeOfPointsOnALine) {
  EXPECT_NEAR(SlopeOf({0.0, 1.0, 3.0}, {1.0, 3.0, 7.0}), 2.0, 1e-12);
  EXPECT_EQ(SlopeOf({1.0, 1.0}, {2.0, 4.0}), 0.0);  // no spread, no slope
}

}  // namespace
}  // namespace sinew::experiment
