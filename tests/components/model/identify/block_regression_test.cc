#include "components/model/identify/block_regression.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <random>

namespace sinew::identify {
namespace {

Rows EvenRows(int segments, int rows_each, double step_s) {
  Rows rows;
  const int n = segments * rows_each;
  rows.time_s.resize(n);
  for (int i = 0; i < n; ++i) {
    rows.time_s[i] = step_s * (i % rows_each);
    rows.segment.push_back(i / rows_each);
    rows.run.push_back(i / rows_each);
    rows.used.push_back(1);
    rows.sample.push_back(i % rows_each);
  }
  return rows;
}

Eigen::MatrixXd Random(int rows, int columns, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd out(rows, columns);
  for (int c = 0; c < columns; ++c) {
    for (int r = 0; r < rows; ++r) out(r, c) = normal(random);
  }
  return out;
}

TEST(BlockRegression, SumsOverBlocksSolveTheBatchProblem) {
  const Rows rows = EvenRows(2, 300, 0.1);
  const Eigen::MatrixXd X = Random(600, 5, 1);
  const Eigen::VectorXd y = Random(600, 1, 2);
  Eigen::MatrixXd G = Eigen::MatrixXd::Zero(5, 5);
  Eigen::VectorXd m = Eigen::VectorXd::Zero(5);
  double yy = 0.0;
  for (const Block& block : MakeBlocks(rows, 3.0, 0.0, 3)) {
    const Moments sums = MomentsOf(block, X, y);
    G += sums.G;
    m += sums.m;
    yy += sums.yy;
  }
  const Eigen::VectorXd batch = X.householderQr().solve(y);
  const Eigen::VectorXd b = Solve(G, m);
  EXPECT_LT((b - batch).norm(), 1e-7);  // the ridge of 1e-9
  Moments total{G, m, yy, 600};
  EXPECT_NEAR(total.SquaredError(b), (y - X * batch).squaredNorm(), 1e-6);
}

TEST(BlockRegression, CollinearColumnsShareTheirPart) {
  Eigen::MatrixXd X = Random(200, 2, 3);
  X.col(1) = X.col(0);
  const Eigen::VectorXd y = 3.0 * X.col(0);
  const Eigen::VectorXd b = Solve(X.transpose() * X, X.transpose() * y);
  EXPECT_NEAR(b[0], 1.5, 1e-5);
  EXPECT_NEAR(b[1], 1.5, 1e-5);
}

TEST(BlockRegression, AnEmptyColumnGetsNothing) {
  Eigen::MatrixXd X = Random(100, 2, 3);
  X.col(1).setZero();
  const Eigen::VectorXd b = Solve(X.transpose() * X, X.transpose() * X.col(0));
  EXPECT_NEAR(b[0], 1.0, 1e-7);
  EXPECT_EQ(b[1], 0.0);
}

TEST(BlockRegression, BlocksStayInTheirSegmentAndKeepTheirGaps) {
  const Rows rows = EvenRows(3, 100, 0.1);
  const std::vector<Block> blocks = MakeBlocks(rows, 2.0, 0.25, 2);
  ASSERT_EQ(blocks.size(), 12u);  // 9.9 s each: 4 windows
  for (const Block& block : blocks) {
    for (const Eigen::Index i : block) {
      EXPECT_EQ(rows.segment[static_cast<std::size_t>(i)],
                rows.segment[static_cast<std::size_t>(block.front())]);
    }
  }
  for (std::size_t b = 0; b + 1 < blocks.size(); ++b) {
    if (rows.segment[static_cast<std::size_t>(blocks[b].back())] !=
        rows.segment[static_cast<std::size_t>(blocks[b + 1].front())]) {
      continue;
    }
    EXPECT_GE(rows.time_s[blocks[b + 1].front()] - rows.time_s[blocks[b].back()], 0.5 - 1e-9);
  }
}

TEST(BlockRegression, ThinWindowsJoinTheirNeighbour) {
  Rows rows = EvenRows(1, 100, 0.1);
  for (int i = 20; i < 60; ++i) rows.used[static_cast<std::size_t>(i)] = 0;
  std::size_t count = 0;
  for (const Block& block : MakeBlocks(rows, 1.0, 0.0, 5)) {
    EXPECT_GE(block.size(), 5u);
    count += block.size();
  }
  EXPECT_EQ(count, 60u);
}

TEST(BlockRegression, RobustErrorsCoverTheTruthWhenNoiseIsCorrelatedInBlocks) {
  // Noise that is constant inside a block: the usual errors would be too small by sqrt(20).
  int covered = 0;
  constexpr int kTrials = 300;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::mt19937_64 random(static_cast<std::uint64_t>(100 + trial));
    std::normal_distribution<double> normal;
    std::vector<Moments> blocks;
    Eigen::MatrixXd G = Eigen::MatrixXd::Zero(1, 1);
    Eigen::VectorXd m = Eigen::VectorXd::Zero(1);
    for (int b = 0; b < 40; ++b) {
      const double level = normal(random);
      const double size = 1.0 + 0.5 * normal(random);
      Eigen::MatrixXd X = Eigen::MatrixXd::Constant(20, 1, size);
      const Eigen::VectorXd y = 2.0 * X.col(0) + Eigen::VectorXd::Constant(20, level);
      Moments sums{X.transpose() * X, X.transpose() * y, y.squaredNorm(), 20.0};
      G += sums.G;
      m += sums.m;
      blocks.push_back(std::move(sums));
    }
    const Eigen::VectorXd b = Solve(G, m);
    const double error = std::sqrt(BlockCovariance(blocks, b)(0, 0));
    covered += std::abs(b[0] - 2.0) < 2.02 * error ? 1 : 0;
  }
  // 95 % of 300 with a binomial margin of three standard deviations, less the sandwich's small
  // bias.
  EXPECT_GE(covered, 270);
  EXPECT_LE(covered, 297);
}

}  // namespace
}  // namespace sinew::identify
