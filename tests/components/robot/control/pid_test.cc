// Oracles: the law's own closed forms.
#include "components/robot/control/pid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace sinew::control {
namespace {

constexpr double kPeriod_s = 1.0 / 240.0;
constexpr double kRounding = 1e-12;  // a few hundred additions of numbers near 1

TEST(Pid, ZeroErrorGivesZeroTorque) {
  Pid pid({.proportional_Nm_rad = 5.0, .integral_Nm_rad_s = 3.0, .derivative_Nm_s_rad = 1.0});
  for (int k = 0; k < 100; ++k) EXPECT_EQ(pid.Step(0.0, 0.0, kPeriod_s), 0.0);
}

TEST(Pid, TermsOfAConstantErrorAreExact) {
  Pid pid({.proportional_Nm_rad = 5.0, .integral_Nm_rad_s = 3.0, .derivative_Nm_s_rad = 0.5});
  for (int k = 1; k <= 200; ++k) {
    EXPECT_NEAR(pid.Step(0.2, -0.4, kPeriod_s), 5.0 * 0.2 + 3.0 * 0.2 * k * kPeriod_s - 0.5 * 0.4,
                kRounding);
  }
}

TEST(Pid, ProportionalControlOfAnIntegratorDecaysGeometrically) {
  Pid pid({.proportional_Nm_rad = 12.0});
  double x = 0.0;  // x_{k+1} = x_k + h u_k: the error is (1 - Kp h)^k
  for (int k = 0; k < 200; ++k) {
    EXPECT_NEAR(1.0 - x, std::pow(1.0 - 12.0 * kPeriod_s, k), kRounding) << k;
    x += kPeriod_s * pid.Step(1.0 - x, 0.0, kPeriod_s);
  }
}

TEST(Pid, PiControlOfAnIntegratorFollowsTheRootsOfItsCharacteristicPolynomial) {
  // e_{k+1} = e_k - h (Kp e_k + I_k), I_k = I_{k-1} + Ki h e_k. Differences of it:
  // e_{k+2} = (2 - h Kp - h^2 Ki) e_{k+1} - (1 - h Kp) e_k.
  const double kp = 10.0, ki = 20.0, h = kPeriod_s;
  Pid pid({.proportional_Nm_rad = kp, .integral_Nm_rad_s = ki});
  const double trace = 2.0 - h * kp - h * h * ki, determinant = 1.0 - h * kp;
  const double discriminant = std::sqrt(0.25 * trace * trace - determinant);
  ASSERT_FALSE(std::isnan(discriminant)) << "chosen so that the roots are real";
  const double r1 = 0.5 * trace + discriminant, r2 = 0.5 * trace - discriminant;
  const double e0 = 1.0, e1 = 1.0 - h * (kp + ki * h);
  const double b = (e1 - r1 * e0) / (r2 - r1), a = e0 - b;
  double x = 0.0;
  for (int k = 0; k < 300; ++k) {
    EXPECT_NEAR(1.0 - x, a * std::pow(r1, k) + b * std::pow(r2, k), 1e-10) << k;
    x += h * pid.Step(1.0 - x, 0.0, h);
  }
}

TEST(Pid, DerivativeFilterIsAFirstOrderLag) {
  const double f = 20.0;
  Pid pid({.derivative_Nm_s_rad = 2.0, .derivative_filter_Hz = f});
  EXPECT_EQ(pid.Step(0.0, 0.0, kPeriod_s), 0.0);
  const double a = kPeriod_s / (kPeriod_s + 1.0 / (2.0 * std::numbers::pi * f));
  for (int k = 1; k < 100; ++k) {
    EXPECT_NEAR(pid.Step(0.0, 3.0, kPeriod_s), 6.0 * (1.0 - std::pow(1.0 - a, k)), kRounding) << k;
  }
}

TEST(Pid, StartsItsFilterOnTheFirstVelocityWithoutAKick) {
  Pid pid({.derivative_Nm_s_rad = 2.0, .derivative_filter_Hz = 5.0});
  EXPECT_EQ(pid.Step(0.0, 3.0, kPeriod_s), 6.0);
  EXPECT_NEAR(pid.Step(0.0, 3.0, kPeriod_s), 6.0, kRounding);
}

TEST(Pid, InSaturationTheIntegralSettlesAtKiETtAboveTheLimit) {
  // I grows by Ki e h and is drawn back by h / Tt (s - u): at rest u - s = Ki e Tt.
  const double tt = 0.2, limit = 1.0;
  Pid pid({.proportional_Nm_rad = 1.0, .integral_Nm_rad_s = 4.0, .anti_windup_s = tt});
  double u = 0.0;
  for (int k = 0; k < 2400; ++k) {
    u = pid.Step(0.5, 0.0, kPeriod_s);
    if (u > limit) pid.Limited(limit - u, kPeriod_s);
  }
  EXPECT_NEAR(u - limit, 4.0 * 0.5 * tt, 1e-9);
  // Without it the integral would need 10 s to come back; with it the sign follows within Tt.
  int ticks = 0;
  while (ticks < 2400 && pid.Step(-0.5, 0.0, kPeriod_s) > 0.0) ++ticks;
  EXPECT_LT(ticks * kPeriod_s, tt);
}

TEST(Pid, IntegralStaysInsideItsLimit) {
  Pid pid({.integral_Nm_rad_s = 100.0, .integral_limit_Nm = 0.7});
  for (int k = 0; k < 1000; ++k) EXPECT_LE(pid.Step(1.0, 0.0, kPeriod_s), 0.7);
  EXPECT_EQ(pid.integral_Nm(), 0.7);
}

TEST(Pid, AMillionStepsInSaturationStayBounded) {
  Pid pid({.proportional_Nm_rad = 10.0,
           .integral_Nm_rad_s = 50.0,
           .derivative_Nm_s_rad = 1.0,
           .derivative_filter_Hz = 30.0});
  double largest = 0.0;
  for (int k = 0; k < 1000000; ++k) {
    const double error = std::sin(1e-3 * k) + 0.5;
    const double u = pid.Step(error, 0.24 * std::cos(1e-3 * k), kPeriod_s);
    const double s = std::clamp(u, -1.0, 1.0);
    pid.Limited(s - u, kPeriod_s);
    largest = std::max(largest, std::abs(u));
  }
  // |P| <= 15, |D| <= 0.24, and the integral at most Ki e Tt below or above what the limit leaves.
  EXPECT_LT(largest, 2.0 * (15.0 + 0.24 + 1.0) + 50.0 * 1.5 * 0.1);
}

TEST(Pid, BadConfigurationIsRefused) {
  EXPECT_THROW(Pid({.proportional_Nm_rad = -1.0}), std::invalid_argument);
  EXPECT_THROW(Pid({.integral_Nm_rad_s = std::nan("")}), std::invalid_argument);
  EXPECT_THROW(Pid({.derivative_Nm_s_rad = HUGE_VAL}), std::invalid_argument);
  EXPECT_THROW(Pid({.anti_windup_s = 0.0}), std::invalid_argument);
  EXPECT_THROW(Pid({.derivative_filter_Hz = -3.0}), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::control
