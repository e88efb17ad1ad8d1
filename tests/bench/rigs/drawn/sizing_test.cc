// Sizes and the test for the known effect, against closed forms.
#include "bench/rigs/drawn/sizing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "bench/rigs/drawn/random.h"

namespace sinew::rigs {
namespace {

constexpr int kRows = 4000;

Balance Synthetic(double correlation, double sine) {
  Random random(5, 0);
  Balance out;
  out.response.resize(kRows);
  out.columns.setOnes(kRows, 1);
  out.prior_sd.setConstant(1, std::numeric_limits<double>::infinity());
  double noise = 0.0;
  for (int i = 0; i < kRows; ++i) {
    noise = correlation * noise + random.Normal();
    out.response[i] = 3.0 + noise + sine * std::sin(0.7 * i);
    out.row.push_back(i);
  }
  return out;
}

Eigen::VectorXd Sine(double size) {
  Eigen::VectorXd out(kRows);
  for (int i = 0; i < kRows; ++i) out[i] = size * std::sin(0.7 * i);
  return out;
}

TEST(Likelihood, NoncentralityIsTheSignaturesEnergyOverTheNoiseAtItsFrequency) {
  const double size = 0.2;
  const double energy = 0.5 * size * size * kRows;
  EXPECT_NEAR(Lambda(Synthetic(0.0, size), Sine(size), true) / energy, 1.0, 0.1);
  // AR(1) noise has the spectrum 1 / |1 - c exp(-i w)|^2.
  const double c = 0.9, w = 0.7;
  const double gain = 1.0 + c * c - 2.0 * c * std::cos(w);
  EXPECT_NEAR(Lambda(Synthetic(c, size), Sine(size), true) / (energy * gain), 1.0, 0.15);
}

TEST(Likelihood, AConstantIsHeldBackOnlyByItsPrior) {
  Balance balance = Synthetic(0.0, 0.0);
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(kRows);
  EXPECT_LT(Lambda(balance, one, true), 1e-3);  // the column takes it over
  balance.prior_sd[0] = 0.2;
  EXPECT_NEAR(Lambda(balance, one, true), 25.0, 1.0);  // (1 / 0.2)^2
}

TEST(Likelihood, LossOfFitIsNoughtForAMultipleAndOneForAnOrthogonalSignature) {
  const Balance balance = Synthetic(0.0, 0.0);
  Eigen::VectorXd cosine(kRows);
  for (int i = 0; i < kRows; ++i) cosine[i] = std::cos(0.7 * i);
  const Eigen::VectorXd ar = Eigen::VectorXd::Zero(kArOrder);
  EXPECT_NEAR(LossOfFit(balance, Sine(1.0), Sine(-7.0), ar), 0.0, 1e-6);
  EXPECT_NEAR(LossOfFit(balance, Sine(1.0), cosine, ar), 1.0, 1e-2);
}

TEST(Likelihood, WhiteningTakesCorrelationAwayAndStopsAtGaps) {
  Balance balance = Synthetic(0.95, 0.0);
  for (int i = kRows / 2; i < kRows; ++i) balance.row[static_cast<std::size_t>(i)] += 100;
  const Eigen::VectorXd left = RefitResidual(balance);
  const Eigen::VectorXd ar = FitAr(left, balance.row, kArOrder);
  EXPECT_NEAR(ar[0], 0.95, 0.06);
  const Eigen::VectorXd white = Whiten(left, balance.row, ar).col(0);
  EXPECT_EQ(white.size(), kRows - 2 * kArOrder);
  const auto n = white.size() - 1;
  EXPECT_NEAR(white.head(n).dot(white.tail(n)) / white.squaredNorm(), 0.0, 0.05);
}

TEST(Sizing, DerivativesOfAParabolaAreExact) {
  Eigen::VectorXd q(200);
  for (int i = 0; i < 200; ++i) q[i] = 1.0 + 0.3 * i / 100.0 + 2.0 * i * i / 1e4;
  const Smooth smooth = Differentiate(q, 100.0, 3.0);
  EXPECT_NEAR(smooth.value[100], q[100], 1e-9);
  EXPECT_NEAR(smooth.velocity[100], 0.3 + 4.0, 1e-9);
  EXPECT_NEAR(smooth.acceleration[100], 4.0, 1e-7);
}

TEST(Sizing, AnEffectGetsTheRequestedShareAndTheTwinHasNone) {
  Rig rig = DrawRig(2);
  rig.rows = std::min(rig.rows, static_cast<int>(25.0 * rig.rate_Hz));
  const Sizer sizer(rig, Excitation::kDesigned);
  const Measured twin = sizer.Measure(Play(rig, {}, Excitation::kDesigned, 3), Shows::kTorque);
  EXPECT_NEAR(twin.share, 0.0, 1e-12);
  EXPECT_EQ(twin.lambda, 0.0);
  const auto sized = sizer.Size(DrawEffect(rig, "direction_dependent_viscous"), kStrongShare);
  ASSERT_TRUE(sized.reached);
  const double odds = sized.measured.share / (1.0 - sized.measured.share);
  EXPECT_NEAR(odds, 0.3 / 0.7, 0.3 * 0.3 / 0.7);
  EXPECT_GT(sized.measured.lambda, kIdentifiableLambda);
  EXPECT_EQ(sizer.ClassOf(sized.effect).front(), "direction_dependent_viscous");
}

}  // namespace
}  // namespace sinew::rigs
