// Energies against closed forms, the stated error bound, and what happens to lost samples.
#include "components/robot/performance/energy.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "components/base/types/angle.h"

namespace sinew::performance {
namespace {

constexpr double kPower_Hz = 240.0;
constexpr double kPowerPeriod_s = 1.0 / kPower_Hz;
constexpr double kNoPower = std::numeric_limits<double>::quiet_NaN();

TEST(PowerIntegral, IsZeroWithoutPower) {
  PowerIntegral integral(kPowerPeriod_s);
  for (std::uint64_t tick = 0; tick < 100; ++tick) integral.Step(tick, 0.0);
  EXPECT_EQ(integral.absolute_J(), 0.0);
  EXPECT_EQ(integral.positive_J(), 0.0);
  EXPECT_EQ(integral.net_J(), 0.0);
}

TEST(PowerIntegral, IsExactForALineThroughZero) {
  PowerIntegral integral(0.1);
  // p = 3 - 7 t from 0 to 1 s; the zero at 3/7 s lies between two samples.
  for (std::uint64_t tick = 0; tick <= 10; ++tick) {
    integral.Step(tick, 3.0 - 0.7 * static_cast<double>(tick));
  }
  EXPECT_NEAR(integral.positive_J(), 9.0 / 14.0, 1e-14);
  EXPECT_NEAR(integral.net_J(), -0.5, 1e-14);
  EXPECT_NEAR(integral.absolute_J(), 9.0 / 14.0 + 8.0 / 7.0, 1e-14);
}

// p = A sin(w t + phase) + c over whole periods: int max(p, 0) dt = (A cos x0 + c (pi/2 + x0)) / pi
// per second, x0 = asin(c / A).
TEST(PowerIntegral, KeepsTheStatedErrorAndShrinksWithTheSquareOfTheStep) {
  constexpr double kAmplitude_W = 20.0, kOffset_W = 4.0;
  const double w_rad_s = 2.0 * types::kPi * 3.0, x0 = std::asin(kOffset_W / kAmplitude_W);
  const double positive_J =
      10.0 * (kAmplitude_W * std::cos(x0) + kOffset_W * (types::kPi / 2.0 + x0)) / types::kPi;
  double last_error_J = 0.0;
  for (const double rate_Hz : {60.0, 120.0, 240.0, 480.0}) {
    const double step_s = 1.0 / rate_Hz;
    PowerIntegral integral(step_s);
    for (std::uint64_t tick = 0; tick <= static_cast<std::uint64_t>(10.0 * rate_Hz); ++tick) {
      integral.Step(
          tick,
          kAmplitude_W * std::sin(w_rad_s * static_cast<double>(tick) * step_s + 0.7) + kOffset_W);
    }
    const double bound_J = 10.0 * step_s * step_s / 12.0 * kAmplitude_W * w_rad_s * w_rad_s;
    const double error_J = std::abs(integral.positive_J() - positive_J);
    EXPECT_LE(error_J, bound_J) << rate_Hz;
    EXPECT_LE(std::abs(integral.net_J() - 10.0 * kOffset_W), bound_J) << rate_Hz;
    EXPECT_LE(std::abs(integral.absolute_J() - (2.0 * positive_J - 10.0 * kOffset_W)),
              2.0 * bound_J);
    if (last_error_J > 0.0) {
      EXPECT_NEAR(last_error_J / error_J, 4.0, 1.5) << rate_Hz;
    }
    last_error_J = error_J;
  }
}

TEST(PowerIntegral, BridgesAShortGapByALineAndCountsIt) {
  PowerIntegral integral(0.01, 0.05);
  integral.Step(0, 1.0);
  integral.Step(1, 1.0);
  integral.Step(2, kNoPower);  // no number
  integral.Step(5, 3.0);       // missing ticks
  EXPECT_NEAR(integral.net_J(), 0.01 + 0.04 * 2.0, 1e-15);
  EXPECT_EQ(integral.coverage().integrated, 1u);
  EXPECT_EQ(integral.coverage().bridged, 4u);
  EXPECT_EQ(integral.coverage().omitted, 0u);
}

TEST(PowerIntegral, AddsNothingForALongGapAndCountsIt) {
  PowerIntegral integral(0.01, 0.05);
  integral.Step(10, kNoPower);  // before the first sample
  integral.Step(12, 5.0);
  for (std::uint64_t tick = 13; tick < 18; ++tick) integral.Step(tick, kNoPower);
  EXPECT_EQ(integral.coverage().pending, 5u);
  integral.Step(18, 5.0);
  EXPECT_EQ(integral.net_J(), 0.0);
  EXPECT_EQ(integral.coverage().omitted, 8u);
  EXPECT_EQ(integral.coverage().pending, 0u);
  integral.Step(19, 5.0);
  EXPECT_NEAR(integral.net_J(), 0.05, 1e-15);
  const Coverage& all = integral.coverage();
  EXPECT_EQ(all.integrated + all.bridged + all.omitted + all.pending, 9u);
}

TEST(PowerIntegral, LeavesOutATickThatIsNotNew) {
  PowerIntegral integral(0.01);
  integral.Step(5, 1.0);
  integral.Step(6, 1.0);
  integral.Step(6, 100.0);
  integral.Step(3, 100.0);
  integral.Step(7, 1.0);
  EXPECT_NEAR(integral.net_J(), 0.02, 1e-15);
}

TEST(PowerIntegral, KeepsItsBridgeErrorForThePowerOfASquat) {
  // Every 12th sample at 240 Hz: gaps of 0.05 s throughout, power of 3 Hz.
  PowerIntegral integral(kPowerPeriod_s);
  const double w_rad_s = 2.0 * types::kPi * 3.0;
  for (std::uint64_t tick = 0; tick <= 2400; ++tick) {
    const double power_W = 1.0 + std::sin(w_rad_s * static_cast<double>(tick) * kPowerPeriod_s);
    integral.Step(tick, tick % 12 == 0 ? power_W : kNoPower);
  }
  EXPECT_EQ(integral.coverage().bridged, 2400u);
  const double bound_J = 10.0 * w_rad_s * w_rad_s * kBridge_s * kBridge_s / 12.0;
  EXPECT_LT(bound_J / 10.0, 0.075);
  EXPECT_NEAR(integral.net_J(), 10.0, bound_J);
}

TEST(PowerIntegral, RefusesTimesThatAreNone) {
  EXPECT_THROW(PowerIntegral(0.0), std::invalid_argument);
  EXPECT_THROW(PowerIntegral(0.01, -1.0), std::invalid_argument);
}

constexpr MotorConstants kGartt{
    .copper_resistance_Ohm = 0.12, .torque_constant_Nm_A = 0.0159, .gear_ratio = 100.0};

// Constant braking: the motor holds 2 N m against -1 rad/s.
TEST(JointEnergy, CountsRegeneratedEnergyOrNotUnderTwoNames) {
  JointEnergy energy(kGartt, 0.01);
  const double current_A = 5.0;
  for (std::uint64_t tick = 0; tick <= 100; ++tick) energy.Step(tick, 2.0, -1.0, current_A);
  const Energies e = energy.energies();
  EXPECT_TRUE(e.electrical_known);
  EXPECT_NEAR(e.net_J, -2.0, 1e-12);
  EXPECT_NEAR(e.absolute_J, 2.0, 1e-12);
  EXPECT_EQ(e.positive_J, 0.0);
  EXPECT_NEAR(e.copper_loss_J, 0.12 * 25.0, 1e-12);
  EXPECT_NEAR(e.electrical_net_J, 0.12 * 25.0 - 0.0159 * 5.0 * 100.0, 1e-12);  // -4.95
  EXPECT_EQ(e.electrical_drawn_J, 0.0);
}

// Laws: absolute = 2 positive - net, drawn >= net, and over a cycle without gear loss the
// electrical energy is copper loss plus mechanical work.
TEST(JointEnergy, BalancesOverACycle) {
  JointEnergy energy(kGartt, kPowerPeriod_s);
  for (std::uint64_t tick = 0; tick <= 2400; ++tick) {
    const double t_s = static_cast<double>(tick) * kPowerPeriod_s;
    const double velocity_rad_s = std::cos(1.3 * t_s), torque_Nm = 3.0 * std::cos(1.3 * t_s + 1.0);
    energy.Step(tick, torque_Nm, velocity_rad_s, torque_Nm / (0.0159 * 100.0));
  }
  const Energies e = energy.energies();
  EXPECT_NEAR(e.absolute_J, 2.0 * e.positive_J - e.net_J, 1e-12);
  EXPECT_GT(e.positive_J, e.net_J);
  EXPECT_GE(e.electrical_drawn_J, e.electrical_net_J);
  EXPECT_NEAR(e.electrical_net_J, e.copper_loss_J + e.net_J, 1e-10);
}

TEST(JointEnergy, LosesOnlyWhatALostSignalEnters) {
  JointEnergy energy(kGartt, 0.01);
  energy.Step(0, 1.0, 1.0, 1.0);
  energy.Step(1, kNoPower, 1.0, 1.0);
  EXPECT_EQ(energy.mechanical().pending, 1u);
  EXPECT_EQ(energy.electrical().integrated, 1u);
  energy.Step(2, 1.0, kNoPower, 1.0);
  EXPECT_EQ(energy.electrical().pending, 1u);
  EXPECT_EQ(energy.copper().integrated, 2u);
  EXPECT_TRUE(std::isnan(energy.electrical_W()));
}

TEST(JointEnergy, ReportsNoElectricalEnergyWithoutAResistance) {
  JointEnergy energy(MotorConstants{}, 0.01);
  for (std::uint64_t tick = 0; tick < 5; ++tick) energy.Step(tick, 1.0, 1.0, 1.0);
  EXPECT_FALSE(energy.energies().electrical_known);
  EXPECT_EQ(energy.energies().electrical_net_J, 0.0);
}

TEST(JointEnergy, RefusesConstantsOutOfRange) {
  for (const MotorConstants& bad : {MotorConstants{-1.0, 0.1, 1.0}, MotorConstants{0.1, 0.0, 1.0},
                                    MotorConstants{0.1, -0.1, 1.0}, MotorConstants{0.1, 0.1, 0.0},
                                    MotorConstants{kNoPower, 0.1, 1.0}}) {
    EXPECT_THROW(JointEnergy(bad, 0.01), std::invalid_argument);
  }
}

}  // namespace
}  // namespace sinew::performance
