#include "components/model/trace/evidence.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <random>

namespace sinew::trace {
namespace {

Eigen::MatrixXd Random(Eigen::Index rows, Eigen::Index columns, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd out(rows, columns);
  for (Eigen::Index c = 0; c < columns; ++c) {
    for (Eigen::Index r = 0; r < rows; ++r) out(r, c) = normal(random);
  }
  return out;
}

struct Regression {
  Eigen::MatrixXd X = Random(400, 3, 1), Z = Random(400, 5, 2);
  Prior prior{Eigen::Vector3d(1.0, -2.0, 0.5), Eigen::Vector3d(4.0, 0.0, 100.0)};
  Eigen::VectorXd precision = Eigen::VectorXd::Constant(5, 0.5);
  Eigen::VectorXd y = X * Eigen::Vector3d(1.2, -1.0, 0.4) + 0.3 * Z.col(3) + Random(400, 1, 3);
  Evidence evidence{X, prior, Z, precision, y};

  // Oracle: ordinary least squares with the priors as further rows.
  double Misfit(const Columns& columns, Eigen::VectorXd* b = nullptr) const {
    const auto extra = static_cast<Eigen::Index>(columns.size());
    Eigen::MatrixXd A(400, 3 + extra);
    A << X, Z(Eigen::all, columns);
    Eigen::VectorXd P(3 + extra), mean = Eigen::VectorXd::Zero(3 + extra);
    P << prior.precision, precision.head(extra);
    mean.head(3) = prior.mean;
    const Eigen::MatrixXd H = A.transpose() * A + Eigen::MatrixXd(P.asDiagonal());
    const Eigen::VectorXd best = H.ldlt().solve(A.transpose() * y + P.cwiseProduct(mean));
    if (b != nullptr) *b = best;
    return (y - A * best).squaredNorm() + ((best - mean).array().square() * P.array()).sum();
  }
};

// Oracle: the Gaussian density of y with its covariance written out.
TEST(Evidence, GainLessOccamIsTwiceTheLogarithmOfTheRatioOfMarginalLikelihoods) {
  Regression problem;
  problem.prior.precision = Eigen::Vector3d(4.0, 1.0, 100.0);
  const Evidence evidence{problem.X, problem.prior, problem.Z, problem.precision, problem.y};
  const auto twice_log_density = [&](const Columns& columns) {
    Eigen::MatrixXd cov = Eigen::MatrixXd::Identity(400, 400);
    cov += problem.X * problem.prior.precision.cwiseInverse().asDiagonal() * problem.X.transpose();
    for (const Eigen::Index j : columns) {
      cov += problem.Z.col(j) * problem.Z.col(j).transpose() / problem.precision[j];
    }
    const Eigen::LLT<Eigen::MatrixXd> factor(cov);
    const Eigen::MatrixXd L = factor.matrixL();
    const Eigen::VectorXd e = problem.y - problem.X * problem.prior.mean;
    return -e.dot(factor.solve(e)) - 2.0 * L.diagonal().array().log().sum();
  };
  const double without = twice_log_density({});
  for (const Columns& columns : {Columns{0}, Columns{3}, Columns{1, 3, 4}}) {
    const double ratio = twice_log_density(columns) - without;
    EXPECT_NEAR(evidence.Gain(columns) - evidence.Occam(columns), ratio,
                1e-5 * std::abs(ratio) + 1e-4);
  }
  EXPECT_LT(evidence.Gain({0}) - evidence.Occam({0}), 0.0) << "a column that says nothing";
  EXPECT_GT(evidence.Gain({3}) - evidence.Occam({3}), 10.0);
}

TEST(Evidence, GainIsTheMisfitThatTheJointFitTakesAway) {
  const Regression problem;
  const double alone = problem.Misfit({});
  EXPECT_NEAR(problem.evidence.misfit(), alone, 1e-6 * alone);
  for (const Columns& columns : {Columns{3}, Columns{0, 3}, Columns{0, 1, 2, 3, 4}}) {
    EXPECT_NEAR(problem.evidence.Gain(columns), alone - problem.Misfit(columns), 1e-6 * alone);
  }
}

TEST(Evidence, CoefficientsAreThoseOfTheJointFit) {
  const Regression problem;
  Eigen::VectorXd b;
  problem.Misfit({1, 3}, &b);
  const Eigen::VectorXd c = problem.evidence.Solve({1, 3});
  EXPECT_NEAR((c - b.tail(2)).norm(), 0.0, 1e-6);
  EXPECT_NEAR((problem.evidence.Declared({1, 3}, c) - b.head(3)).norm(), 0.0, 1e-6);
}

TEST(Evidence, PriorMisfitIsWhatTheDeclaredValuesMissTheirTolerancesBy) {
  const Regression problem;
  Eigen::VectorXd b;
  problem.Misfit({1, 3}, &b);
  const double expected =
      ((b.head(3) - problem.prior.mean).array().square() * problem.prior.precision.array()).sum();
  EXPECT_NEAR(problem.evidence.PriorMisfit({1, 3}, problem.evidence.Solve({1, 3})), expected,
              1e-6 * expected);
}

TEST(Evidence, NothingIsGainedByNoColumn) {
  const Regression problem;
  EXPECT_EQ(problem.evidence.Gain({}), 0.0);
}

TEST(Evidence, AColumnThatTheDeclaredTermsCarryHasNoFreePart) {
  Regression problem;
  problem.Z.col(0) = problem.X * Eigen::Vector3d(0.0, 2.0, 0.0);
  const Prior flat{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  const Evidence evidence(problem.X, flat, problem.Z, problem.precision, problem.y);
  EXPECT_LT(evidence.FreeShare(0), 1e-6);
  EXPECT_GT(evidence.FreeShare(1), 0.9);
}

TEST(Evidence, CollinearColumnsShareTheirCoefficientInsteadOfExploding) {
  Regression problem;
  problem.Z.col(4) = problem.Z.col(3) * (1.0 + 1e-12);
  const Evidence evidence(problem.X, problem.prior, problem.Z, problem.precision, problem.y);
  const Eigen::VectorXd c = evidence.Solve({3, 4});
  EXPECT_NEAR(c[0] + c[1], 0.3, 0.15);
  EXPECT_LT(c.cwiseAbs().maxCoeff(), 1.0);
}

TEST(Evidence, APriorHoldsWhatTheRowsDoNotShow) {
  Regression problem;
  problem.X.col(2).setZero();
  const Evidence evidence(problem.X, problem.prior, problem.Z, problem.precision, problem.y);
  EXPECT_NEAR(evidence.Declared({}, Eigen::VectorXd())[2], problem.prior.mean[2], 1e-9);
}

}  // namespace
}  // namespace sinew::trace
