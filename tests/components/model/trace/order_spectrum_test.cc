#include "components/model/trace/order_spectrum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace sinew::trace {
namespace {

constexpr Eigen::Index kTurnRows = 8000;

// A motor that turns to and fro over 30 turns, seen at uneven instants.
Eigen::VectorXd Angle() {
  Eigen::VectorXd out(kTurnRows);
  for (Eigen::Index i = 0; i < kTurnRows; ++i) {
    const double t = 0.0125 * static_cast<double>(i);
    out[i] = 2.0 * std::numbers::pi * 15.0 * std::sin(0.3 * t) + 3.0 * std::sin(1.7 * t);
  }
  return out;
}

Eigen::VectorXd Line(const Eigen::VectorXd& angle, double order, double noise) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  Eigen::VectorXd out(angle.size());
  for (Eigen::Index i = 0; i < angle.size(); ++i) {
    out[i] = std::sin(order * angle[i] + 0.4) + noise * normal(random);
  }
  return out;
}

TEST(OrderSpectrum, FindsALineFarAboveTheNyquistFrequency) {
  const Eigen::VectorXd angle = Angle();
  // 84 periods a turn at up to 4.5 turns a second: 378 Hz, sampled at 80 Hz.
  for (const double order : {4.0, 7.0, 42.0, 84.0, 137.25}) {
    const OrderLine line = StrongestOrder(Line(angle, order, 2.0), angle, 0.5, 200.0);
    EXPECT_NEAR(line.order, order, 0.5 / TurnsCovered(angle)) << order;
  }
}

TEST(OrderSpectrum, PowerIsThatOfTheExactSum) {
  const Eigen::VectorXd angle = Angle();
  const Eigen::VectorXd g = Line(angle, 11.0, 0.0);
  const OrderLine line = StrongestOrder(g, angle, 0.5, 40.0);
  double c = 0.0, s = 0.0;
  for (Eigen::Index i = 0; i < kTurnRows; ++i) {
    c += g[i] * std::cos(line.order * angle[i]);
    s += g[i] * std::sin(line.order * angle[i]);
  }
  // Sharing rows between cells damps high orders by up to 5 % of the amplitude.
  EXPECT_NEAR(line.power, c * c + s * s, 0.1 * (c * c + s * s));
}

// Where the joint is quick, the inertia answers a ripple alone: the torque shows it only where the
// angle creeps, and the quick rows are louder.
TEST(OrderSpectrum, ARippleIsFoundInTheRowsThatAreSlowEnoughForIt) {
  constexpr Eigen::Index kAll = 8000;
  constexpr double kOrder = 30.0, kBand = 2.0 * M_PI * 10.0, kPeriod = 0.01;
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  Eigen::VectorXd angle(kAll), speed(kAll), g(kAll);
  double at = 0.0;
  for (Eigen::Index i = 0; i < kAll; ++i) {
    speed[i] = i % 2000 < 400 ? 1.0 : 25.0;  // 4.8 and 119 periods per second
    at += kPeriod * speed[i] * (i % 4000 < 2000 ? 1.0 : -1.0);
    angle[i] = at;
    const bool slow = kOrder * speed[i] < kBand;
    g[i] = (slow ? std::sin(kOrder * at) : 0.0) + (slow ? 0.3 : 10.0) * normal(random);
  }
  const OrderLine line = StrongestRipple(g, angle, speed, kBand, 1.0, 200.0);
  EXPECT_NEAR(line.order, kOrder, 0.1);  // the slow rows cover less of the angle
  EXPECT_GT(std::abs(StrongestOrder(g, angle, 1.0, 200.0).order - kOrder), 1.0);
}

// A fitted line leaves its skirts: the next one is not among them.
TEST(OrderSpectrum, WhatIsKnownIsNotFoundAgain) {
  const Eigen::VectorXd angle = Angle();
  const Eigen::VectorXd g = Line(angle, 14.0, 0.0) + 0.7 * Line(angle, 42.0, 0.0);
  EXPECT_NEAR(StrongestOrder(g, angle, 0.5, 200.0).order, 14.0, 0.1);
  EXPECT_NEAR(StrongestOrder(g, angle, 0.5, 200.0, {14.02}).order, 42.0, 0.1);
}

TEST(OrderSpectrum, AnAngleThatStandsHasNoOrders) {
  const Eigen::VectorXd angle = Eigen::VectorXd::Constant(100, 2.0);
  EXPECT_EQ(StrongestOrder(Eigen::VectorXd::Ones(100), angle, 0.5, 40.0).order, 0.0);
  EXPECT_EQ(TurnsCovered(angle), 0.0);
}

}  // namespace
}  // namespace sinew::trace
