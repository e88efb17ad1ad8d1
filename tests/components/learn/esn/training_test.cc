#include "components/learn/esn/training.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <stdexcept>

#include "components/learn/esn/normal.h"

namespace sinew::esn {
namespace {

struct Problem {
  Eigen::MatrixXd x;  // n x T
  Eigen::MatrixXd y;  // O x T
};

Problem SomeProblem(int features, int outputs, int samples, double noise) {
  NormalGenerator random(5);
  Problem p{Eigen::MatrixXd(features, samples), Eigen::MatrixXd(outputs, samples)};
  for (Eigen::Index i = 0; i < p.x.size(); ++i) p.x.data()[i] = random.Next();
  // Features that are nearly the same, as neurons are.
  for (int f = 1; f < features; f += 3) p.x.row(f) = p.x.row(f - 1) + 0.01 * p.x.row(f);
  Eigen::MatrixXd w(outputs, features);
  for (Eigen::Index i = 0; i < w.size(); ++i) w.data()[i] = random.Next();
  p.y = w * p.x;
  for (Eigen::Index i = 0; i < p.y.size(); ++i) p.y.data()[i] += noise * random.Next();
  return p;
}

NormalEquations Gather(const Problem& p, std::optional<simd::Instructions> set = {}) {
  NormalEquations equations(static_cast<int>(p.x.rows()), static_cast<int>(p.y.rows()), set);
  for (Eigen::Index t = 0; t < p.x.cols(); ++t) EXPECT_TRUE(equations.Add(p.x.col(t), p.y.col(t)));
  return equations;
}

TEST(Ridge, GathersTheSumsOfProductsForAnyNumberOfSamples) {
  for (const int samples : {1, 127, 128, 129, 1000}) {
    const Problem p = SomeProblem(35, 3, samples, 0.1);
    NormalEquations equations = Gather(p);
    EXPECT_EQ(equations.samples(), samples);
    // Sums of 1000 products of order 1.
    EXPECT_LT((equations.FeatureProducts() - p.x * p.x.transpose()).cwiseAbs().maxCoeff(), 1e-11);
    EXPECT_LT((equations.CrossProducts() - p.x * p.y.transpose()).cwiseAbs().maxCoeff(), 1e-10);
    EXPECT_LT((equations.TargetSquares() - p.y.rowwise().squaredNorm()).cwiseAbs().maxCoeff(),
              1e-9);
  }
}

TEST(Ridge, EveryInstructionSetGathersTheSameBits) {
  const Problem p = SomeProblem(70, 2, 700, 0.1);
  NormalEquations reference = Gather(p, simd::Instructions::kPortable);
  for (const simd::Instructions set : {simd::Instructions::kAvx2, simd::Instructions::kAvx512}) {
    if (!simd::Runs(set)) continue;
    NormalEquations equations = Gather(p, set);
    EXPECT_EQ(equations.FeatureProducts(), reference.FeatureProducts()) << simd::Name(set);
    EXPECT_EQ(equations.CrossProducts(), reference.CrossProducts()) << simd::Name(set);
  }
}

TEST(Ridge, SolvesTheNormalEquations) {
  const Problem p = SomeProblem(40, 2, 500, 0.1);
  for (const double beta : {1e-6, 0.01, 10.0}) {
    NormalEquations equations = Gather(p);
    const Eigen::MatrixXd w = SolveRidge(equations, beta);
    // As the closed form, by another decomposition.
    const Eigen::MatrixXd g = p.x * p.x.transpose() + beta * Eigen::MatrixXd::Identity(40, 40);
    const Eigen::MatrixXd expected = g.fullPivLu().solve(p.x * p.y.transpose()).transpose();
    EXPECT_LT((w - expected).norm(), 1e-9 * expected.norm()) << beta;
    // And as the minimum: the gradient vanishes.
    const Eigen::MatrixXd gradient = (w * p.x - p.y) * p.x.transpose() + beta * w;
    EXPECT_LT(gradient.norm(), 1e-9 * (p.y * p.x.transpose()).norm()) << beta;
  }
}

TEST(Ridge, RefusesWhatCannotBeSolved) {
  const Problem p = SomeProblem(10, 1, 5, 0.0);
  NormalEquations equations = Gather(p);
  EXPECT_THROW(SolveRidge(equations, 0.0), std::invalid_argument);
  EXPECT_THROW(SolveRidge(equations, -1.0), std::invalid_argument);
  EXPECT_THROW(SolveRidge(equations, std::nan("")), std::invalid_argument);
  EXPECT_NO_THROW(SolveRidge(equations, 1e-3));
  EXPECT_THROW(NormalEquations(0, 1), std::invalid_argument);
  EXPECT_FALSE(
      equations.Add(Eigen::VectorXd::Constant(10, std::nan("")), Eigen::VectorXd::Zero(1)));
  EXPECT_FALSE(equations.Add(Eigen::VectorXd::Zero(9), Eigen::VectorXd::Zero(1)));
  EXPECT_EQ(equations.samples(), 5);
}

// Leave-one-out errors of ridge regression in closed form are e_i / (1 - h_ii); GCV puts the mean
// of h for each h_ii. First the closed form is checked against really leaving one out, then GCV
// against the closed form.
TEST(Gcv, IsLeaveOneOutWithTheMeanLeverage) {
  const Problem p = SomeProblem(12, 1, 60, 0.5);
  const Eigen::Index samples = p.x.cols();
  NormalEquations equations = Gather(p);
  const std::vector<double> betas = LogarithmicGrid(1e-3, 1e3, 7);
  const std::vector<GcvPoint> points = GeneralisedCrossValidation(equations, betas);
  for (std::size_t b = 0; b < betas.size(); ++b) {
    const Eigen::MatrixXd g = p.x * p.x.transpose() + betas[b] * Eigen::MatrixXd::Identity(12, 12);
    const Eigen::MatrixXd hat = p.x.transpose() * g.ldlt().solve(p.x);
    const Eigen::VectorXd error = p.y.transpose() - hat * p.y.transpose();

    for (const Eigen::Index left_out : {Eigen::Index{0}, Eigen::Index{17}}) {
      Problem rest{Eigen::MatrixXd(12, samples - 1), Eigen::MatrixXd(1, samples - 1)};
      Eigen::Index to = 0;
      for (Eigen::Index t = 0; t < samples; ++t) {
        if (t == left_out) continue;
        rest.x.col(to) = p.x.col(t);
        rest.y.col(to++) = p.y.col(t);
      }
      NormalEquations without = Gather(rest);
      const double predicted = (SolveRidge(without, betas[b]) * p.x.col(left_out))(0);
      EXPECT_NEAR(p.y(0, left_out) - predicted, error(left_out) / (1.0 - hat(left_out, left_out)),
                  1e-9);
    }

    const double mean_leverage = hat.trace() / static_cast<double>(samples);
    const double expected =
        (error / (1.0 - mean_leverage)).squaredNorm() / static_cast<double>(samples);
    EXPECT_NEAR(points[b].score, expected, 1e-9 * expected) << betas[b];
    EXPECT_NEAR(points[b].effective_parameters, hat.trace(), 1e-9) << betas[b];
  }
}

TEST(Gcv, PrefersLittleRidgeWithoutNoiseAndMoreWithNoise) {
  const auto best = [](double noise) {
    NormalEquations equations = Gather(SomeProblem(30, 1, 60, noise));
    const auto points = GeneralisedCrossValidation(equations, LogarithmicGrid(1e-6, 1e4, 20));
    return std::min_element(points.begin(), points.end(),
                            [](const auto& a, const auto& b) { return a.score < b.score; })
        ->beta;
  };
  EXPECT_LT(best(1e-4), 1e-3);
  EXPECT_GT(best(20.0), 1.0);
}

TEST(Gcv, RefusesImpossibleGrids) {
  NormalEquations equations = Gather(SomeProblem(5, 1, 20, 0.1));
  EXPECT_THROW(GeneralisedCrossValidation(equations, {}), std::invalid_argument);
  EXPECT_THROW(GeneralisedCrossValidation(equations, {1.0, 0.0}), std::invalid_argument);
  EXPECT_THROW(LogarithmicGrid(1.0, 1.0, 5), std::invalid_argument);
  EXPECT_THROW(LogarithmicGrid(0.0, 1.0, 5), std::invalid_argument);
  const std::vector<double> grid = LogarithmicGrid(1e-2, 1e2, 5);
  EXPECT_THAT(grid, testing::Pointwise(testing::DoubleNear(1e-12), {0.01, 0.1, 1.0, 10.0, 100.0}));
}

// y(t+1) = 0.3 y + 0.05 y sum_{i<10} y(t-i) + 1.5 u(t-9) u(t) + 0.1, u uniform in 0 .. 0.5
// (Atiya and Parlos 2000, eq. 86).
Sequence Narma10(int samples, std::uint64_t seed, Use use) {
  std::mt19937_64 bits(seed);
  Eigen::VectorXd u(samples);
  for (int t = 0; t < samples; ++t) u(t) = 0.5 * static_cast<double>(bits() >> 11) * 0x1p-53;
  Eigen::VectorXd y = Eigen::VectorXd::Zero(samples);
  for (int t = 9; t + 1 < samples; ++t) {
    y(t + 1) = 0.3 * y(t) + 0.05 * y(t) * y.segment(t - 9, 10).sum() + 1.5 * u(t - 9) * u(t) + 0.1;
  }
  Sequence q;
  q.inputs = u.head(samples - 1);
  q.targets = y.tail(samples - 1);  // y(t+1) from u(t)
  q.use.assign(static_cast<std::size_t>(samples - 1), use);
  return q;
}

TEST(Training, LearnsNarma10) {
  TrainingConfig config;
  config.hyper.neurons = 300;
  config.hyper.spectral_radius = 0.9;
  config.hyper.input_variance = 0.01;
  config.hyper.leak = 1.0;
  config.period_s = 1.0;
  config.washout_s = 200.0;
  const TrainingResult result =
      Train({Narma10(3000, 1, Use::kTrain), Narma10(2000, 2, Use::kTest)}, config);
  EXPECT_EQ(result.train.samples, 3000 - 1 - 200);
  EXPECT_EQ(result.test.samples, 2000 - 1 - 200);
  // Echo state networks of this size are reported between 0.15 and 0.4 (Rodan and Tino 2011, Fig. 5
  // as NMSE); a linear memory of ten inputs stays near 0.4, the mean has 1.
  const double nrmse = std::sqrt(result.test.normalised(0));
  EXPECT_LT(nrmse, 0.35);
  EXPECT_GT(nrmse, 0.01);  // better would mean that the target leaks in
}

TEST(Training, FindsALinearMapExactlyAndInItsOwnUnits) {
  NormalGenerator random(11);
  Sequence q;
  q.inputs.resize(2000, 2);
  q.targets.resize(2000, 2);
  for (int t = 0; t < 2000; ++t) {
    const double a = 100.0 + 30.0 * random.Next();
    const double b = 1e-3 * random.Next();
    q.inputs.row(t) << a, b;
    q.targets.row(t) << 5.0 + 0.2 * a - 300.0 * b, -7.0 * a;
  }
  q.use.assign(2000, Use::kTrain);
  for (std::size_t t = 1500; t < 2000; ++t) q.use[t] = Use::kTest;
  TrainingConfig config;
  config.hyper.neurons = 20;
  config.ridge_beta = 1e-9;
  const TrainingResult result = Train({q}, config);
  EXPECT_LT(result.test.normalised.maxCoeff(), 1e-15);
  Network network(result.weights);
  ASSERT_EQ(network.Step(Eigen::Vector2d(110.0, 2e-3)), StepStatus::kOk);
  EXPECT_NEAR(network.prediction()(0), 5.0 + 22.0 - 0.6, 1e-5);
  EXPECT_NEAR(network.prediction()(1), -770.0, 1e-4);
}

TEST(Training, UsesOnlyTheSamplesMarkedForIt) {
  Sequence a = Narma10(1000, 3, Use::kTrain);
  TrainingConfig config;
  config.hyper.neurons = 30;
  config.period_s = 1.0;
  config.washout_s = 50.0;
  for (std::size_t t = 500; t < a.use.size(); ++t) a.use[t] = Use::kNone;
  Sequence b = a;
  b.targets.bottomRows(400).setConstant(1e6);  // rubbish where it must not be looked at
  b.targets.topRows(50).setConstant(-1e6);
  EXPECT_EQ(Train({a}, config).weights.readout, Train({b}, config).weights.readout);
  b.targets(300, 0) += 1.0;
  EXPECT_NE(Train({a}, config).weights.readout, Train({b}, config).weights.readout);
}

TEST(Training, AnInputThatNeverVariesDoesNoHarm) {
  Sequence q = Narma10(1000, 3, Use::kTrain);
  const Eigen::VectorXd u = q.inputs.col(0);
  q.inputs.resize(u.size(), 2);
  q.inputs << u, Eigen::VectorXd::Constant(u.size(), 0.7);
  TrainingConfig config;
  config.hyper.neurons = 30;
  const TrainingResult result = Train({q}, config);
  EXPECT_EQ(result.weights.input.scale(1), 1.0);
  EXPECT_TRUE(result.weights.readout.allFinite());
}

TEST(Training, TheSameSeedAndDataGiveTheSameBits) {
  TrainingConfig config;
  config.hyper.neurons = 50;
  const std::vector<Sequence> data = {Narma10(1000, 3, Use::kTrain)};
  EXPECT_EQ(Train(data, config).weights.readout, Train(data, config).weights.readout);
}

TEST(Training, RefusesDataThatDoNotFit) {
  const Sequence good = Narma10(500, 1, Use::kTrain);
  TrainingConfig config;
  config.hyper.neurons = 10;
  EXPECT_THROW(Train({}, config), std::invalid_argument);
  Sequence bad = good;
  bad.use.pop_back();
  EXPECT_THROW(Train({bad}, config), std::invalid_argument);
  bad = good;
  bad.inputs(3, 0) = std::numeric_limits<double>::infinity();
  EXPECT_THROW(Train({bad}, config), std::invalid_argument);
  bad = good;
  bad.inputs.resize(good.inputs.rows(), 2);
  bad.inputs.setZero();
  EXPECT_THROW(Train({good, bad}, config), std::invalid_argument);
  bad = good;
  std::fill(bad.use.begin(), bad.use.end(), Use::kTest);
  EXPECT_THROW(Train({bad}, config), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::esn
