// The bound against the squats that the thesis reports energies of.
#include "components/robot/performance/lifting.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>

namespace sinew::performance {
namespace {

constexpr double kBiped_kg = 17.1;

double SquatHeight_m(double t_s) {  // two cycles in 10 s, 0.65 m to 0.25 m
  return 0.45 + 0.2 * std::cos(2.0 * std::numbers::pi * 0.2 * t_s);
}

TEST(LiftingBound, OfTwoSquatsIs134Joule) {
  LiftingBound bound(kBiped_kg, 0.01);
  for (int i = 0; i <= 2400; ++i) bound.Step(SquatHeight_m(i / 240.0));
  EXPECT_NEAR(bound.rise_m(), 0.8, 1e-4);
  EXPECT_NEAR(bound.work_J(), 134.2, 0.1);  // above the published 42.44 J
  EXPECT_NEAR(LiftingWork_J(kBiped_kg, 0.8 * 0.7), 94.0, 0.1);
}

TEST(LiftingBound, CountsNoNoiseWithinHalfTheBandAndAtMostTwiceItPerRise) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> noise(-0.004, 0.004);
  LiftingBound at_rest(kBiped_kg, 0.01), squats(kBiped_kg, 0.01);
  for (int i = 0; i < 100000; ++i) at_rest.Step(0.65 + noise(random));
  EXPECT_EQ(at_rest.rise_m(), 0.0);
  for (int i = 0; i <= 2400; ++i) squats.Step(SquatHeight_m(i / 240.0) + noise(random));
  EXPECT_GE(squats.rise_m(), 0.8 - 1e-4);
  EXPECT_LE(squats.rise_m(), 0.8 + 2 * 2 * 0.004);
}

TEST(LiftingBound, IsZeroForAFallAndContainsARiseThatHasNotEnded) {
  LiftingBound bound(2.0, 0.01);
  bound.Step(1.0);
  bound.Step(0.2);
  EXPECT_EQ(bound.work_J(), 0.0);
  bound.Step(0.5);
  EXPECT_NEAR(bound.work_J(), 2.0 * 9.81 * 0.3, 1e-12);
}

TEST(LiftingBound, LeavesOutWhatIsNotFiniteAndCountsIt) {
  LiftingBound bound(1.0, 0.01);
  bound.Step(std::numeric_limits<double>::quiet_NaN());
  bound.Step(0.0);
  bound.Step(std::numeric_limits<double>::infinity());
  bound.Step(0.5);
  EXPECT_NEAR(bound.rise_m(), 0.5, 1e-15);
  EXPECT_EQ(bound.lost(), 2u);
}

TEST(LiftingBound, RefusesFiguresOutOfRange) {
  EXPECT_THROW(LiftingBound(0.0, 0.01), std::invalid_argument);
  EXPECT_THROW(LiftingBound(1.0, 0.0), std::invalid_argument);
  EXPECT_THROW(LiftingBound(1.0, 0.01, std::nan("")), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::performance
