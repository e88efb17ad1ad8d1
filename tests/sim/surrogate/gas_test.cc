#include "sim/surrogate/gas.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace sinew::surrogate {
namespace {

constexpr double kWarm_K = 293.15;
constexpr double kKappa = Air::kCp_J_kgK / Air::kCv_J_kgK;

TEST(Vessel, CompressionWithoutHeatFollowsTheAdiabate) {
  Vessel vessel(1e-5, 7e5, kWarm_K, 0.0);
  // There and back in 20000 small steps.
  for (int i = 1; i <= 10000; ++i) {
    vessel.SetVolume(1e-5 * (1.0 - 0.4e-4 * i));
    vessel.ExchangeHeat(kWarm_K, 1e-4);
  }
  // p V^kappa = constant; the series in SetVolume is exact to 1e-13 a step.
  EXPECT_NEAR(vessel.pressure_Pa(), 7e5 * std::pow(1.0 / 0.6, kKappa), 1e-7 * 7e5);
  for (int i = 9999; i >= 0; --i) vessel.SetVolume(1e-5 * (1.0 - 0.4e-4 * i));
  EXPECT_NEAR(vessel.pressure_Pa(), 7e5, 1e-7 * 7e5);
}

TEST(Vessel, OneLargeStepGivesTheSameAdiabateAsManySmallOnes) {
  Vessel vessel(1e-5, 7e5, kWarm_K, 0.0);
  vessel.SetVolume(0.6e-5);
  EXPECT_NEAR(vessel.pressure_Pa(), 7e5 * std::pow(1.0 / 0.6, kKappa), 1e-6);
}

TEST(Vessel, CompressionAtAGoodWallIsIsothermal) {
  Vessel vessel(1e-5, 7e5, kWarm_K, 1e5);
  for (int i = 1; i <= 10000; ++i) {
    vessel.SetVolume(1e-5 * (1.0 - 0.4e-4 * i));
    vessel.ExchangeHeat(kWarm_K, 1e-4);
  }
  EXPECT_NEAR(vessel.pressure_Pa(), 7e5 / 0.6, 1e-6 * 7e5);
  EXPECT_NEAR(vessel.temperature_K(), kWarm_K, 1e-6);
}

TEST(Vessel, WallTemperatureIsApproachedExponentially) {
  Vessel vessel(1e-5, 7e5, 350.0, 0.15);
  const double rate_1_s = 0.15 / (vessel.mass_kg() * Air::kCv_J_kgK);
  for (int i = 0; i < 1000; ++i) vessel.ExchangeHeat(kWarm_K, 1e-4);
  EXPECT_NEAR(vessel.temperature_K(), kWarm_K + (350.0 - kWarm_K) * std::exp(-rate_1_s * 0.1),
              1e-3);
}

TEST(Vessel, MassAndEnergyAreKeptWhenTwoVesselsLevel) {
  Vessel high(1e-5, 7e5, kWarm_K, 0.0), low(2e-3, 1e5, kWarm_K, 0.0);
  const double mass_kg = high.mass_kg() + low.mass_kg();
  const double energy_J = high.energy_J() + low.energy_J();
  const Orifice orifice{1.5e-9, 0.3};
  for (int i = 0; i < 24000; ++i) {
    const double moved_kg = MassFlow_kg_s(orifice, high.pressure_Pa(), high.temperature_K(),
                                          low.pressure_Pa(), low.temperature_K()) /
                            24000.0;
    const double high_K = high.temperature_K(), low_K = low.temperature_K();
    high.AddMass(-moved_kg, low_K);
    low.AddMass(moved_kg, high_K);
  }
  EXPECT_NEAR(high.mass_kg() + low.mass_kg(), mass_kg, 1e-12 * mass_kg);
  EXPECT_NEAR(high.energy_J() + low.energy_J(), energy_J, 1e-12 * energy_J);
  EXPECT_NEAR(high.pressure_Pa(), low.pressure_Pa(), 1.0);
}

TEST(Vessel, AnEmptyVesselFilledFromASupplyEndsKappaTimesWarmer) {
  // First law with the supply's enthalpy and no heat: m cv T = m cp T_supply.
  Vessel vessel(1e-5, 1.0, kWarm_K, 0.0);
  for (int i = 0; i < 1000; ++i) vessel.AddMass(1e-7, kWarm_K);
  EXPECT_NEAR(vessel.temperature_K(), kKappa * kWarm_K, 0.01);
}

TEST(Vessel, RefusesWhatIsNoVessel) {
  EXPECT_THROW(Vessel(0.0, 1e5, kWarm_K, 0.0), std::invalid_argument);
  EXPECT_THROW(Vessel(1e-5, -1.0, kWarm_K, 0.0), std::invalid_argument);
}

TEST(Orifice, NoDifferenceNoFlow) {
  EXPECT_EQ(MassFlow_kg_s({1e-9, 0.3}, 5e5, kWarm_K, 5e5, kWarm_K), 0.0);
}

TEST(Orifice, ChokedFlowIsTheSonicOneWhateverIsDownstream) {
  // ISO 6358: C rho0 p1 at the reference temperature.
  const double expected_kg_s = 1e-9 * Air::kReferenceDensity_kg_m3 * 7e5;
  EXPECT_NEAR(MassFlow_kg_s({1e-9, 0.3}, 7e5, kWarm_K, 0.3 * 7e5, kWarm_K), expected_kg_s, 1e-12);
  EXPECT_NEAR(MassFlow_kg_s({1e-9, 0.3}, 7e5, kWarm_K, 1e5, kWarm_K), expected_kg_s, 1e-12);
}

TEST(Orifice, SubsonicFlowFollowsTheEllipseAndIsContinuous) {
  const Orifice orifice{1e-9, 0.3};
  const double sonic_kg_s = MassFlow_kg_s(orifice, 7e5, kWarm_K, 0.0, kWarm_K);
  const double x = (0.8 - 0.3) / 0.7;
  EXPECT_NEAR(MassFlow_kg_s(orifice, 7e5, kWarm_K, 0.8 * 7e5, kWarm_K),
              sonic_kg_s * std::sqrt(1.0 - x * x), 1e-12);
  const double below = MassFlow_kg_s(orifice, 7e5, kWarm_K, 0.995 * 7e5 - 1.0, kWarm_K);
  const double above = MassFlow_kg_s(orifice, 7e5, kWarm_K, 0.995 * 7e5 + 1.0, kWarm_K);
  EXPECT_NEAR(below, above, 1e-3 * sonic_kg_s);
}

TEST(Orifice, FlowTurnsWithTheSides) {
  const Orifice orifice{1e-9, 0.3};
  EXPECT_EQ(MassFlow_kg_s(orifice, 6e5, 300.0, 2e5, 290.0),
            -MassFlow_kg_s(orifice, 2e5, 290.0, 6e5, 300.0));
}

TEST(Relay, ActsAfterItsDeadTimeAndForgetsShortPulses) {
  Relay relay({0.015, 0.010, 0.0});
  constexpr double kHeatStep_s = 0.001;
  int steps = 0;
  while (relay.Step(true, kHeatStep_s) == 0.0) ++steps;
  EXPECT_NEAR(steps * kHeatStep_s, 0.015, 0.0011);
  for (int i = 0; i < 9; ++i) EXPECT_EQ(relay.Step(false, kHeatStep_s), 1.0);  // 9 ms off: not seen
  EXPECT_EQ(relay.Step(true, kHeatStep_s), 1.0);
  for (int i = 0; i < 20; ++i) relay.Step(false, kHeatStep_s);
  EXPECT_EQ(relay.opening(), 0.0);
}

TEST(Relay, TravelsLinearly) {
  Relay relay({0.0, 0.0, 0.1});
  for (int i = 0; i < 51; ++i) relay.Step(true, 0.001);
  EXPECT_NEAR(relay.opening(), 0.5, 0.0101);
  EXPECT_THROW(Relay({-1.0, 0.0, 0.0}), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::surrogate
