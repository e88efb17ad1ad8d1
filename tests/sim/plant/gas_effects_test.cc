#include "sim/plant/gas_effects.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/plant/pneumatics.h"

namespace sinew::plant {
namespace {

constexpr double kChamberStep_s = 1e-4;
constexpr double kStart_bar = 4.0;

PneumaticConfig Chamber() {
  PneumaticConfig config;
  config.chamber_volume_m3 = 2e-3;
  config.reservoir_volume_m3 = 0.0;
  config.source_pressure_bar = 6.0;
  config.initial_pressure_bar = kStart_bar;
  config.torque_slope_Nm_bar = 20.0;
  return config;
}

actuator::JointModel GasModel(const char* effect, std::vector<double> theta,
                              std::vector<double> psi = {}) {
  actuator::JointModel model;
  model.constants.gas_volume_m3 = 2e-3;
  model.constants.atmosphere_bar = kAmbientPressure_bar;
  model.terms.push_back(actuator::MakeTerm(effect, model.constants, effects::Balance::kGas));
  for (std::size_t i = 0; i < theta.size(); ++i) model.terms[0].linear[i].value = theta[i];
  for (std::size_t i = 0; i < psi.size(); ++i) model.terms[0].nonlinear[i].value = psi[i];
  return model;
}

// Turns at velocity_rad_s with the valve shut.
double PressureAfter(GasEffects& gas, double velocity_rad_s, double seconds) {
  PneumaticElement element(Chamber());
  double q = 0.0;
  element.Reset(q);
  for (long k = 0; k < std::lround(seconds / kChamberStep_s); ++k) {
    const double before = element.chamber_volume_m3(q);
    q += velocity_rad_s * kChamberStep_s;
    const double volume = element.chamber_volume_m3(q);
    const double rate =
        gas.Rate_bar_s(element.pressure_bar(), element.pressure_rate_bar_s(),
                       (volume - before) / (kChamberStep_s * volume), false, kChamberStep_s);
    element.Step({}, q, kChamberStep_s, rate);
  }
  return element.pressure_bar();
}

TEST(GasEffects, WithoutTermsChangeNothing) {
  GasEffects gas{actuator::JointModel{}};
  EXPECT_EQ(gas.Rate_bar_s(3.0, 1.0, 1.0, false, kChamberStep_s), 0.0);
  EXPECT_TRUE(gas.Valve(true, kChamberStep_s));
}

// Laminar, x = (P + Pa) / Pa: dx/dt = -c (x^2 - 1), so that
// (x - 1) / (x + 1) = its value at the start times exp(-2 c t).
TEST(GasEffects, ALaminarLeakFollowsItsClosedForm) {
  constexpr double kLeak_1_s = 0.01;
  constexpr double kTime_s = 5.0;
  GasEffects gas(GasModel("leak", {kLeak_1_s}, {1.0}));
  const double start = 1.0 + kStart_bar / kAmbientPressure_bar;
  const double share = (start - 1.0) / (start + 1.0) * std::exp(-2.0 * kLeak_1_s * kTime_s);
  const double end = (1.0 + share) / (1.0 - share);
  // Explicit steps of 0.1 ms: far below 1e-4.
  EXPECT_NEAR(PressureAfter(gas, 0.0, kTime_s), kAmbientPressure_bar * (end - 1.0), 1e-4);
}

// A stroke much faster than the wall: p V^1.4 stays; the model is its first order.
TEST(GasEffects, AFastStrokeIsAdiabatic) {
  GasEffects gas(GasModel("gas_heat_exchange", {1.0, 1.0}, {60.0}));
  const double pressure = PressureAfter(gas, -1.0, 0.2);
  const double ratio = 1.0 / (1.0 - 1e-5 * 20.0 * 0.2 / 2e-3);
  const double start = kStart_bar + kAmbientPressure_bar;
  const double adiabatic = start * std::pow(ratio, 1.4) - start;
  EXPECT_NEAR(pressure - kStart_bar, adiabatic, 0.02 * adiabatic);
}

// A slow one is isothermal.
TEST(GasEffects, ASlowStrokeIsIsothermal) {
  GasEffects gas(GasModel("gas_heat_exchange", {1.0, 1.0}, {0.02}));
  const double pressure = PressureAfter(gas, -0.02, 10.0);
  const double ratio = 1.0 / (1.0 - 1e-5 * 20.0 * 0.2 / 2e-3);
  const double isothermal = (kStart_bar + kAmbientPressure_bar) * (ratio - 1.0);
  EXPECT_NEAR(pressure - kStart_bar, isothermal, 0.02 * isothermal);
}

TEST(GasEffects, AValveOpensLateAndShutsAtOnce) {
  GasEffects gas(GasModel("valve_dead_time", {0.03}));
  int steps = 0;
  while (!gas.Valve(true, kChamberStep_s)) ++steps;
  EXPECT_NEAR(steps * kChamberStep_s, 0.03, 2.0 * kChamberStep_s);
  EXPECT_FALSE(gas.Valve(false, kChamberStep_s));
  EXPECT_FALSE(gas.Valve(true, kChamberStep_s));
}

}  // namespace
}  // namespace sinew::plant
