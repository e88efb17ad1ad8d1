#include "components/trace/cross_validation.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <random>

#include "components/identify/statistics.h"

namespace sinew::trace {
namespace {

struct Problem {
  Eigen::MatrixXd base;
  Eigen::MatrixXd extra;
  Eigen::VectorXd target;
  std::vector<identify::Block> blocks;
};

Problem MakeProblem(int blocks, int rows_each, double effect, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Problem out;
  const int n = blocks * rows_each;
  out.base.resize(n, 3);
  out.extra.resize(n, 1);
  out.target.resize(n);
  for (int i = 0; i < n; ++i) {
    for (int c = 0; c < 3; ++c) out.base(i, c) = normal(random);
    out.extra(i, 0) = 0.5 * out.base(i, 1) + normal(random);
    out.target[i] = effect * out.extra(i, 0) + normal(random);
  }
  for (int b = 0; b < blocks; ++b) {
    identify::Block block;
    for (int i = 0; i < rows_each; ++i) block.push_back(b * rows_each + i);
    out.blocks.push_back(std::move(block));
  }
  return out;
}

// Leaves the folds out by hand.
Eigen::VectorXd ByHand(const Problem& problem, const Eigen::MatrixXd& X, const Eigen::VectorXd& y,
                       int folds) {
  Eigen::VectorXd errors(static_cast<Eigen::Index>(problem.blocks.size()));
  for (int f = 0; f < folds; ++f) {
    std::vector<Eigen::Index> train;
    for (std::size_t b = 0; b < problem.blocks.size(); ++b) {
      if (static_cast<int>(b) % folds == f) continue;
      train.insert(train.end(), problem.blocks[b].begin(), problem.blocks[b].end());
    }
    const Eigen::VectorXd b = X(train, Eigen::all).householderQr().solve(y(train));
    for (std::size_t k = static_cast<std::size_t>(f); k < problem.blocks.size();
         k += static_cast<std::size_t>(folds)) {
      const auto& rows = problem.blocks[k];
      errors[static_cast<Eigen::Index>(k)] = (y(rows) - X(rows, Eigen::all) * b).squaredNorm();
    }
  }
  return errors;
}

TEST(CrossValidation, SumsOverBlocksAgreeWithLeavingOutByHand) {
  const Problem problem = MakeProblem(23, 15, 0.3, 1);
  Eigen::MatrixXd X(problem.base.rows(), 4);
  X << problem.base, problem.extra;
  const std::vector<Setting> setting = {
      Setting(problem.blocks, problem.base, problem.extra, problem.target, 10)};
  const Eigen::VectorXd sums = LeftOutErrors(setting, Eigen::VectorXd::Ones(23), 10);
  EXPECT_LT((sums - ByHand(problem, X, problem.target, 10)).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(CrossValidation, SignsOfBlocksActLikeFlippedTargets) {
  const Problem problem = MakeProblem(12, 10, 0.5, 2);
  Eigen::VectorXd signs(12);
  Eigen::VectorXd flipped = problem.target;
  for (int b = 0; b < 12; ++b) {
    signs[b] = b % 3 == 0 ? -1.0 : 1.0;
    for (const Eigen::Index i : problem.blocks[static_cast<std::size_t>(b)]) flipped[i] *= signs[b];
  }
  const std::vector<Setting> setting = {
      Setting(problem.blocks, problem.base, problem.extra, problem.target, 6)};
  Eigen::MatrixXd X(problem.base.rows(), 4);
  X << problem.base, problem.extra;
  EXPECT_LT(
      (LeftOutErrors(setting, signs, 6) - ByHand(problem, X, flipped, 6)).cwiseAbs().maxCoeff(),
      1e-6);
}

TEST(CrossValidation, SettingsCompeteInsideTheFolds) {
  const Problem problem = MakeProblem(20, 12, 1.0, 3);
  const Eigen::MatrixXd useless = Eigen::MatrixXd::Random(problem.base.rows(), 1);
  std::vector<Setting> both;
  both.emplace_back(problem.blocks, problem.base, useless, problem.target, 10);
  both.emplace_back(problem.blocks, problem.base, problem.extra, problem.target, 10);
  const std::vector<Setting> right = {both[1]};
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(20);
  EXPECT_LT((LeftOutErrors(both, ones, 10) - LeftOutErrors(right, ones, 10)).norm(), 1e-12);
}

TEST(CrossValidation, ATrueEffectGainsAndNoiseDoesNot) {
  double false_gain = 0.0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    for (const double effect : {0.0, 0.5}) {
      const Problem problem = MakeProblem(40, 15, effect, seed);
      const Eigen::VectorXd ones = Eigen::VectorXd::Ones(40);
      const std::vector<Setting> base = {Setting(problem.blocks, problem.base,
                                                 Eigen::MatrixXd(problem.base.rows(), 0),
                                                 problem.target, 10)};
      const std::vector<Setting> with = {
          Setting(problem.blocks, problem.base, problem.extra, problem.target, 10)};
      const Gain gain = GainOf(LeftOutErrors(base, ones, 10) - LeftOutErrors(with, ones, 10));
      if (effect > 0.0) {
        EXPECT_GT(gain.t, 3.0) << seed;
        EXPECT_LT(gain.p, 0.01);
      } else {
        false_gain += gain.t > 2.0 ? 1.0 : 0.0;
      }
    }
  }
  EXPECT_LE(false_gain, 2.0);
}

TEST(CrossValidation, GainIsTheSumWithTheErrorOfTheMean) {
  Eigen::VectorXd gains(4);
  gains << 1.0, 2.0, 3.0, 4.0;
  const Gain gain = GainOf(gains);
  EXPECT_DOUBLE_EQ(gain.sum, 10.0);
  EXPECT_NEAR(gain.standard_error, std::sqrt(4.0 * 5.0 / 3.0), 1e-12);
  EXPECT_NEAR(gain.p, identify::StudentCdf(-gain.t, 3.0), 1e-15);
  EXPECT_EQ(GainOf(Eigen::VectorXd::Zero(1)).t, 0.0);
  EXPECT_EQ(GainOf(Eigen::VectorXd::Zero(5)).p, 1.0);
}

// An effect that acts in some of thirty blocks, always by the same amount, in much noise elsewhere.
double SizeWhereBlocksExcite(int exciting, double size) {
  Problem problem = MakeProblem(30, 40, 0.0, 5);
  for (int b = exciting; b < 30; ++b) problem.extra.middleRows(b * 40, 40).setZero();
  problem.target += size * problem.extra.col(0);
  const Setting setting(problem.blocks, problem.base, problem.extra, problem.target, 10);
  return SizeInErrors(Joined(setting.blocks(), setting.Coefficients(), problem.base.cols()));
}

TEST(SizeInErrors, FewBlocksThatAgreeAreCertain) {
  EXPECT_GT(SizeWhereBlocksExcite(30, 1.0), 20.0);
  EXPECT_GT(SizeWhereBlocksExcite(4, 1.0), 6.0);
}

TEST(SizeInErrors, OneBlockIsNot) { EXPECT_LT(SizeWhereBlocksExcite(1, 1.0), 2.0); }

TEST(SizeInErrors, NoiseIsFewErrorsLarge) { EXPECT_LT(SizeWhereBlocksExcite(30, 0.0), 4.0); }

TEST(Joined, TheWholeEffectHasSizeOne) {
  const Problem problem = MakeProblem(12, 30, 0.7, 9);
  Eigen::MatrixXd extra(problem.target.size(), 2);
  extra << problem.extra, problem.base.col(0).cwiseAbs();
  const Setting setting(problem.blocks, problem.base, extra, problem.target, 6);
  Eigen::MatrixXd G = Eigen::MatrixXd::Zero(4, 4);
  Eigen::VectorXd m = Eigen::VectorXd::Zero(4);
  for (const auto& block : Joined(setting.blocks(), setting.Coefficients(), 3)) {
    G += block.G;
    m += block.m;
  }
  EXPECT_NEAR(identify::Solve(G, m)[3], 1.0, 1e-6);
}

}  // namespace
}  // namespace sinew::trace
