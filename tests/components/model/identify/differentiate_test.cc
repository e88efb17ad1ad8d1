#include "components/model/identify/differentiate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace sinew::identify {
namespace {

TEST(Differentiate, CentralDifferenceIsExactForParabolasInside) {
  const double dt = 0.01;
  Eigen::VectorXd x(50);
  for (int i = 0; i < 50; ++i) x[i] = 1.0 + 2.0 * i * dt + 3.0 * i * dt * i * dt;
  const Eigen::VectorXd d = CentralDifference(x, dt);
  for (int i = 1; i < 49; ++i) EXPECT_NEAR(d[i], 2.0 + 6.0 * i * dt, 1e-11);
}

TEST(Differentiate, WideDifferenceIsExactForPolynomialsOfDegreeEight) {
  const double dt = 0.1;
  Eigen::VectorXd x(40);
  for (int i = 0; i < 40; ++i) x[i] = std::pow(0.05 * i - 1.0, 8);
  const Eigen::VectorXd d = WideDifference(x, dt);
  for (int i = 4; i < 36; ++i) {
    EXPECT_NEAR(d[i], 8.0 * std::pow(0.05 * i - 1.0, 7) * 0.5, 1e-12);
  }
}

TEST(Differentiate, WideDifferenceKeepsWhatTwoPointsLose) {
  // A fifth of the rate: w dt = 1.257. Two points have sin(w dt) / (w dt) = 0.757 of the slope.
  const double dt = 1.0 / 80.0;
  const double w = 2.0 * M_PI * 16.0;
  Eigen::VectorXd x(400);
  for (int i = 0; i < 400; ++i) x[i] = std::sin(w * i * dt);
  const Eigen::VectorXd wide = WideDifference(x, dt);
  const Eigen::VectorXd two = CentralDifference(x, dt);
  for (int i = 100; i < 300; ++i) {
    EXPECT_NEAR(wide[i], w * std::cos(w * i * dt), 0.01 * w);
    EXPECT_NEAR(two[i], 0.7568 * w * std::cos(w * i * dt), 0.001 * w);
  }
}

TEST(Differentiate, AStandingSignalHasNoSlope) {
  const Eigen::VectorXd x = Eigen::VectorXd::Constant(20, 7.0);
  EXPECT_EQ(CentralDifference(x, 0.1).cwiseAbs().maxCoeff(), 0.0);
  EXPECT_NEAR(WideDifference(x, 0.1).cwiseAbs().maxCoeff(), 0.0, 1e-13);
}

TEST(Differentiate, TooFewSamplesAreRefused) {
  EXPECT_THROW(CentralDifference(Eigen::VectorXd::Zero(2), 0.1), std::invalid_argument);
  EXPECT_THROW(WideDifference(Eigen::VectorXd::Zero(4), 0.1), std::invalid_argument);
}

TEST(Differentiate, NonFiniteInputIsNotHidden) {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(20);
  x[10] = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(WideDifference(x, 0.1).allFinite());
}

}  // namespace
}  // namespace sinew::identify
