#include "components/learn/rls/rls.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include "tests/support/allocations.h"

namespace sinew::rls {
namespace {

class Random {
 public:
  explicit Random(std::uint64_t seed) : bits_(seed) {}
  double Next() { return normal_(bits_); }
  Eigen::VectorXd Vector(int n) {
    Eigen::VectorXd v(n);
    for (int i = 0; i < n; ++i) v(i) = Next();
    return v;
  }
  Eigen::MatrixXd Matrix(int rows, int columns) {
    Eigen::MatrixXd m(rows, columns);
    for (Eigen::Index i = 0; i < m.size(); ++i) m.data()[i] = Next();
    return m;
  }

 private:
  std::mt19937_64 bits_;
  std::normal_distribution<double> normal_;
};

Config Plain() {
  Config config;
  config.forgetting = 1.0;
  config.leak = 0.0;
  config.clip_sigmas = 0.0;
  return config;
}

// Relative; the recursion and the batch solution round differently over hundreds of updates.
constexpr double kSame = 1e-9;

TEST(Rls, EqualsBatchLeastSquaresWithoutForgettingAndLeak) {
  for (const auto& [features, outputs] : {std::pair{1, 1}, {2, 1}, {7, 3}, {8, 2}, {33, 12}}) {
    Random random(1);
    const Config config = Plain();
    const Eigen::MatrixXd offline = random.Matrix(outputs, features);
    RecursiveLeastSquares rls(config, offline);
    Eigen::MatrixXd information =
        config.prior_precision * Eigen::MatrixXd::Identity(features, features);
    Eigen::MatrixXd right = config.prior_precision * offline;
    for (int t = 0; t < 400; ++t) {
      const Eigen::VectorXd phi = random.Vector(features);
      const Eigen::VectorXd y = random.Vector(outputs);
      ASSERT_EQ(rls.Update(phi, y), UpdateStatus::kOk);
      information += phi * phi.transpose();
      right += y * phi.transpose();
    }
    const Eigen::MatrixXd expected = information.ldlt().solve(right.transpose()).transpose();
    EXPECT_LT((rls.readout() - expected).norm(), kSame * expected.norm()) << features;
    const Eigen::MatrixXd covariance = information.inverse();
    EXPECT_LT((rls.Covariance() - covariance).norm(), kSame * covariance.norm()) << features;
    EXPECT_NEAR(rls.CovarianceTrace(), covariance.trace(), kSame * covariance.trace());
  }
}

TEST(Rls, EqualsWeightedBatchLeastSquaresWithForgettingAndLeak) {
  Random random(2);
  const int features = 13;
  Config config = Plain();
  config.forgetting = 0.98;
  config.leak = 1.0;
  const Eigen::MatrixXd offline = random.Matrix(2, features);
  RecursiveLeastSquares rls(config, offline);
  // The same recursion on the information side: M <- lambda M + phi phi', then + rho e_i e_i'.
  const double rho = features * (1.0 - config.forgetting) * config.prior_precision;
  Eigen::MatrixXd information =
      config.prior_precision * Eigen::MatrixXd::Identity(features, features);
  Eigen::MatrixXd right = config.prior_precision * offline;
  for (int t = 0; t < 1000; ++t) {
    const Eigen::VectorXd phi = random.Vector(features);
    const Eigen::VectorXd y = random.Vector(2);
    ASSERT_EQ(rls.Update(phi, y), UpdateStatus::kOk);
    information = config.forgetting * information + phi * phi.transpose();
    right = config.forgetting * right + y * phi.transpose();
    const int i = t % features;
    information(i, i) += rho;
    right.col(i) += rho * offline.col(i);
  }
  const Eigen::MatrixXd expected = information.ldlt().solve(right.transpose()).transpose();
  EXPECT_LT((rls.readout() - expected).norm(), kSame * expected.norm());
  const Eigen::MatrixXd covariance = information.inverse();
  EXPECT_LT((rls.Covariance() - covariance).norm(), kSame * covariance.norm());
}

// Kulhavy's recursion as it is printed, with the information matrix itself.
TEST(Rls, DirectionalForgettingIsThatOfItsSource) {
  Random random(12);
  const int features = 9;
  Config config = Plain();
  config.forgetting = 0.9;
  config.directional = true;
  const Eigen::MatrixXd offline = random.Matrix(2, features);
  RecursiveLeastSquares rls(config, offline);
  Eigen::MatrixXd information =
      config.prior_precision * Eigen::MatrixXd::Identity(features, features);
  Eigen::MatrixXd weight = offline;
  for (int t = 0; t < 300; ++t) {
    // Of different size, so that epsilon has either sign.
    const Eigen::VectorXd phi = std::pow(10.0, random.Next()) * random.Vector(features);
    const Eigen::VectorXd y = random.Vector(2);
    ASSERT_EQ(rls.Update(phi, y), UpdateStatus::kOk);
    const Eigen::VectorXd p_phi = information.ldlt().solve(phi);
    const double spread = phi.dot(p_phi);
    weight += (y - weight * phi) * p_phi.transpose() / (1.0 + spread);
    information += (config.forgetting - (1.0 - config.forgetting) / spread) * phi * phi.transpose();
  }
  EXPECT_LT((rls.readout() - weight).norm(), 1e-7 * weight.norm());
  const Eigen::MatrixXd covariance = information.inverse();
  EXPECT_LT((rls.Covariance() - covariance).norm(), 1e-7 * covariance.norm());
}

TEST(Rls, DirectionalForgettingKeepsWhatIsNotExcited) {
  Random random(13);
  const int features = 8;
  Config config = Plain();
  config.forgetting = 0.95;
  const Eigen::MatrixXd truth = random.Matrix(1, features);
  for (const bool directional : {true, false}) {
    config.directional = directional;
    RecursiveLeastSquares rls(config, Eigen::MatrixXd::Zero(1, features));
    for (int t = 0; t < 300; ++t) {
      const Eigen::VectorXd phi = random.Vector(features);
      ASSERT_EQ(rls.Update(phi, truth * phi), UpdateStatus::kOk);
    }
    const double before = rls.Covariance()(features - 1, features - 1);
    for (int t = 0; t < 300; ++t) {
      Eigen::VectorXd phi = random.Vector(features);
      phi(features - 1) = 0.0;
      ASSERT_EQ(rls.Update(phi, truth * phi), UpdateStatus::kOk);
    }
    const double growth = rls.Covariance()(features - 1, features - 1) / before;
    if (directional) {
      EXPECT_LT(growth, 2.0);
      EXPECT_LT((rls.readout() - truth).norm(), 1e-3);
    } else {
      EXPECT_GT(growth, 1e6);  // 1 / 0.95^300
    }
  }
}

TEST(Rls, DirectionalForgettingFollowsAChange) {
  Random random(14);
  const int features = 20;
  Config config = Plain();
  config.forgetting = 0.6;  // 50 samples for each of 20 directions
  config.directional = true;
  RecursiveLeastSquares rls(config, Eigen::MatrixXd::Zero(1, features));
  for (int change = 0; change < 3; ++change) {
    const Eigen::MatrixXd truth = random.Matrix(1, features);
    for (int t = 0; t < 2000; ++t) {
      const Eigen::VectorXd phi = random.Vector(features);
      ASSERT_EQ(rls.Update(phi, truth * phi), UpdateStatus::kOk);
    }
    EXPECT_LT((rls.readout() - truth).norm(), 1e-3 * truth.norm()) << change;
  }
}

TEST(Rls, EveryInstructionSetGivesTheSameBits) {
  Config config;
  config.forgetting = 0.99;
  for (const auto& [set, directional] : {std::pair{simd::Instructions::kAvx2, false},
                                         {simd::Instructions::kAvx512, false},
                                         {simd::Instructions::kAvx2, true},
                                         {simd::Instructions::kAvx512, true}}) {
    if (!simd::Runs(set)) continue;
    config.directional = directional;
    Random random(3);
    const Eigen::MatrixXd offline = random.Matrix(2, 21);
    RecursiveLeastSquares reference(config, offline, simd::Instructions::kPortable);
    RecursiveLeastSquares rls(config, offline, set);
    for (int t = 0; t < 2000; ++t) {
      const Eigen::VectorXd phi = random.Vector(21);
      const Eigen::VectorXd y = random.Vector(2);
      ASSERT_EQ(rls.Update(phi, y), reference.Update(phi, y));
    }
    EXPECT_EQ(Eigen::MatrixXd(rls.readout()), Eigen::MatrixXd(reference.readout()))
        << simd::Name(set);
    EXPECT_EQ(rls.Covariance(), reference.Covariance()) << simd::Name(set);
  }
}

TEST(Rls, APerfectReadoutStaysAndTheCovarianceShrinks) {
  Random random(4);
  const Eigen::MatrixXd w = random.Matrix(1, 10);
  RecursiveLeastSquares rls(Plain(), w);
  double trace = rls.CovarianceTrace();
  EXPECT_NEAR(trace, 10 / 0.01, 1e-9);
  for (int t = 0; t < 100; ++t) {
    const Eigen::VectorXd phi = random.Vector(10);
    ASSERT_EQ(rls.Update(phi, w * phi), UpdateStatus::kOk);
    EXPECT_LT(rls.CovarianceTrace(), trace);
    trace = rls.CovarianceTrace();
  }
  // Innovations are rounding only; the gain is below one.
  EXPECT_LT((rls.readout() - w).norm(), 1e-12);
}

// Features that stay the same: nothing is learnt about the other directions and forgetting takes
// all of it. The plain recursion P <- (P - k phi' P) / lambda grows without bound here; its growth
// is the control of the test.
TEST(Rls, StaysBoundedWithoutExcitation) {
  const int features = 40;
  Random random(5);
  Config config;
  config.forgetting = 0.99;
  const Eigen::MatrixXd w = random.Matrix(2, features);
  RecursiveLeastSquares rls(config, w);
  const Eigen::VectorXd phi = random.Vector(features);
  Eigen::MatrixXd plain = Eigen::MatrixXd::Identity(features, features) / config.prior_precision;
  for (int t = 0; t < 200000; ++t) {
    const Eigen::VectorXd y = w * phi + 0.01 * random.Vector(2);
    ASSERT_NE(rls.Update(phi, y), UpdateStatus::kBadInput);
    if (t < 2000) {
      const Eigen::VectorXd k = plain * phi / (config.forgetting + phi.dot(plain * phi));
      plain = ((plain - k * phi.transpose() * plain) / config.forgetting).eval();
    }
  }
  const Eigen::VectorXd eigenvalues =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(rls.Covariance()).eigenvalues();
  EXPECT_GT(eigenvalues.minCoeff(), 0.0);
  // Between two visits a coordinate loses lambda^features of its information: 1 / (delta lambda^40)
  // = 1.5 / delta.
  EXPECT_LT(eigenvalues.maxCoeff(), 2.0 / config.prior_precision);
  EXPECT_GT(plain.trace(), 1e6 / config.prior_precision);
  EXPECT_LT((rls.readout() - w).norm(), 0.1);
}

TEST(Rls, ReturnsToTheOfflineReadoutInDirectionsThatAreNoLongerExcited) {
  Random random(6);
  Config config;
  config.forgetting = 0.99;
  config.clip_sigmas = 0.0;
  const Eigen::MatrixXd offline = Eigen::MatrixXd::Zero(1, 4);
  RecursiveLeastSquares rls(config, offline);
  const Eigen::RowVector4d other(1.0, -2.0, 3.0, 0.5);
  for (int t = 0; t < 2000; ++t) {
    const Eigen::VectorXd phi = random.Vector(4);
    ASSERT_EQ(rls.Update(phi, other * phi), UpdateStatus::kOk);
  }
  EXPECT_LT((rls.readout() - other).norm(), 0.01);
  for (int t = 0; t < 5000; ++t) {  // only the first coordinate
    Eigen::VectorXd phi = Eigen::VectorXd::Zero(4);
    phi(0) = random.Next();
    ASSERT_EQ(rls.Update(phi, other * phi), UpdateStatus::kOk);
  }
  EXPECT_NEAR(rls.readout()(0, 0), 1.0, 0.01);
  EXPECT_LT(rls.readout().rightCols(3).norm(), 0.01);
}

// One feature, one output: weighted least squares in closed form, W = w phi y / (p + w phi^2), with
// the weight w = limit / |innovation| that the header states, limit = clip_sigmas x
// initial_innovation.
TEST(Rls, AnOutlierCountsByTheLimitOverItsSize) {
  Config config = Plain();
  config.prior_precision = 2.0;
  config.clip_sigmas = 3.0;
  config.initial_innovation = 0.1;
  for (const double y : {0.2, 1.0, 12.0}) {
    RecursiveLeastSquares rls(config, Eigen::MatrixXd::Zero(1, 1));
    const double phi = 1.5, w = std::min(1.0, 0.3 / y);
    const UpdateStatus status =
        rls.Update(Eigen::VectorXd::Constant(1, phi), Eigen::VectorXd::Constant(1, y));
    EXPECT_EQ(status, w < 1.0 ? UpdateStatus::kClipped : UpdateStatus::kOk) << y;
    EXPECT_NEAR(rls.readout()(0, 0), w * phi * y / (2.0 + w * phi * phi), kSame) << y;
  }
}

TEST(Rls, FollowsAChangeAndASingleOutlierMovesLittle) {
  Random random(7);
  Config config;
  config.forgetting = 0.995;
  const int features = 20;
  const Eigen::MatrixXd before = random.Matrix(1, features);
  RecursiveLeastSquares rls(config, before);
  const auto run = [&](const Eigen::MatrixXd& truth, int samples) {
    for (int t = 0; t < samples; ++t) {
      const Eigen::VectorXd phi = random.Vector(features);
      ASSERT_NE(rls.Update(phi, truth * phi + 0.01 * random.Vector(1)), UpdateStatus::kBadInput);
    }
  };
  run(before, 2000);
  EXPECT_LT((rls.readout() - before).norm(), 0.02);

  const Eigen::MatrixXd settled = rls.readout();
  const Eigen::VectorXd phi = random.Vector(features);
  EXPECT_EQ(rls.Update(phi, Eigen::VectorXd::Constant(1, 1e6)), UpdateStatus::kClipped);
  EXPECT_LT((rls.readout() - settled).norm(), 0.02);

  const Eigen::MatrixXd after = before + random.Matrix(1, features);
  run(after, 1500);
  EXPECT_LT((rls.readout() - after).norm(), 0.05);
  EXPECT_GT(rls.clipped(), 1u);
  EXPECT_LT(rls.clipped(), rls.updates() / 4);
}

TEST(Rls, InputThatIsNotFiniteOrDoesNotFitChangesNothing) {
  Random random(8);
  RecursiveLeastSquares rls(Config{}, random.Matrix(2, 5));
  ASSERT_NE(rls.Update(random.Vector(5), random.Vector(2)), UpdateStatus::kBadInput);
  const Eigen::MatrixXd readout = rls.readout();
  const Eigen::MatrixXd covariance = rls.Covariance();
  Eigen::VectorXd phi = random.Vector(5);
  phi(4) = std::nan("");
  EXPECT_EQ(rls.Update(phi, random.Vector(2)), UpdateStatus::kBadInput);
  Eigen::VectorXd y = random.Vector(2);
  y(0) = std::numeric_limits<double>::infinity();
  EXPECT_EQ(rls.Update(random.Vector(5), y), UpdateStatus::kBadInput);
  EXPECT_EQ(rls.Update(random.Vector(4), random.Vector(2)), UpdateStatus::kBadInput);
  EXPECT_EQ(rls.Update(random.Vector(5), random.Vector(3)), UpdateStatus::kBadInput);
  EXPECT_EQ(Eigen::MatrixXd(rls.readout()), readout);
  EXPECT_EQ(rls.Covariance(), covariance);
  EXPECT_EQ(rls.updates(), 1u);
}

// Forged messages hold any finite value; before there was a limit, an innovation that overflowed
// made the readout not a number until the next session.
TEST(Rls, NoFiniteInputMakesReadoutOrCovarianceOverflow) {
  for (const bool directional : {false, true}) {
    Random random(18);
    Config config;
    config.directional = directional;
    RecursiveLeastSquares rls(config, random.Matrix(1, 5));
    std::mt19937 choose(18);
    std::uniform_real_distribution<double> exponent(-308.0, 308.0);
    const auto huge = [&](double value) { return value * std::pow(10.0, exponent(choose)); };
    int refused = 0, taken = 0;
    for (int k = 0; k < 20000; ++k) {
      Eigen::VectorXd phi = random.Vector(5), y = random.Vector(1);
      Eigen::MatrixXd readout = random.Matrix(1, 5);
      for (Eigen::VectorXd* values : {&phi, &y}) {
        if (choose() % 2 == 0) *values = values->unaryExpr(huge);
      }
      if (choose() % 4 == 0) (void)rls.SetReadout(readout.unaryExpr(huge));
      ++(rls.Update(phi, y) == UpdateStatus::kBadInput ? refused : taken);
      ASSERT_TRUE(rls.readout().allFinite()) << "update " << k;
      ASSERT_TRUE(std::isfinite(rls.CovarianceTrace())) << "update " << k;
    }
    EXPECT_GT(refused, 5000);
    EXPECT_GT(taken, 5000);
  }
}

TEST(Rls, ZeroFeaturesTeachNothing) {
  Config config = Plain();
  Random random(9);
  const Eigen::MatrixXd w = random.Matrix(1, 5);
  RecursiveLeastSquares rls(config, w);
  ASSERT_EQ(rls.Update(Eigen::VectorXd::Zero(5), Eigen::VectorXd::Ones(1)), UpdateStatus::kOk);
  EXPECT_EQ(Eigen::MatrixXd(rls.readout()), w);
  EXPECT_NEAR(rls.CovarianceTrace(), 5 / config.prior_precision, 1e-9);
}

TEST(Rls, ResetForgetsEverything) {
  Random random(10);
  const Eigen::MatrixXd w = random.Matrix(1, 6);
  RecursiveLeastSquares rls(Config{}, w);
  for (int t = 0; t < 50; ++t)
    ASSERT_NE(rls.Update(random.Vector(6), random.Vector(1)), UpdateStatus::kBadInput);
  rls.Reset();
  EXPECT_EQ(Eigen::MatrixXd(rls.readout()), w);
  EXPECT_EQ(rls.Covariance(),
            Eigen::MatrixXd(Eigen::MatrixXd::Identity(6, 6) / Config{}.prior_precision));
  EXPECT_EQ(rls.updates(), 0u);
}

TEST(Rls, UpdateTakesNoMemory) {
  Random random(11);
  RecursiveLeastSquares rls(Config{}, random.Matrix(12, 77));
  const Eigen::VectorXd phi = random.Vector(77);
  const Eigen::VectorXd y = random.Vector(12);
  bool good = true;
  const long before = test::Allocations();
  for (int t = 0; t < 100; ++t) good = good && rls.Update(phi, y) != UpdateStatus::kBadInput;
  const double trace = rls.CovarianceTrace();
  const long taken = test::Allocations() - before;
  EXPECT_EQ(taken, 0);
  EXPECT_TRUE(good);
  EXPECT_GT(trace, 0.0);
}

TEST(Rls, ImpossibleConfigurationIsNamed) {
  const auto message = [](auto change) {
    Config config;
    change(config);
    try {
      RecursiveLeastSquares rls(config, Eigen::MatrixXd::Zero(1, 3));
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(message([](Config& c) { c.forgetting = 1.01; }),
              testing::StartsWith("forgetting: 1.01"));
  EXPECT_THAT(message([](Config& c) { c.forgetting = 0.0; }), testing::StartsWith("forgetting: 0"));
  EXPECT_THAT(message([](Config& c) { c.prior_precision = 0.0; }),
              testing::StartsWith("prior_precision: 0"));
  EXPECT_THAT(message([](Config& c) { c.leak = -1.0; }), testing::StartsWith("leak: -1"));
  EXPECT_THAT(message([](Config& c) { c.clip_sigmas = std::nan(""); }),
              testing::StartsWith("clip_sigmas: "));
  EXPECT_THAT(message([](Config& c) { c.innovation_memory = 1.0; }),
              testing::StartsWith("innovation_memory: 1"));
  EXPECT_THAT(message([](Config& c) { c.initial_innovation = 0.0; }),
              testing::StartsWith("initial_innovation: 0"));
  EXPECT_THROW(RecursiveLeastSquares(Config{}, Eigen::MatrixXd(0, 3)), std::invalid_argument);
  EXPECT_THROW(RecursiveLeastSquares(Config{}, Eigen::MatrixXd::Constant(1, 2, std::nan(""))),
               std::invalid_argument);
}

}  // namespace
}  // namespace sinew::rls
