#include "sim/plant/pneumatics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace sinew::plant {
namespace {

constexpr double kGasStep_s = 1e-4;

PneumaticConfig Rig() {
  PneumaticConfig config;
  config.source_pressure_bar = 6.0;
  config.torque_slope_Nm_bar = 0.36;
  config.stiffness_slope_Nm_rad_bar = 4.0;
  config.rest_angle_rad = 0.16;
  return config;
}

void RunFor(PneumaticElement& element, const Relays& relays, double position_rad, double seconds) {
  for (long k = 0; k < std::lround(seconds / kGasStep_s); ++k) {
    element.Step(relays, position_rad, kGasStep_s);
  }
}

TEST(Pneumatics, KeepsItsGasWhenEverythingIsShut) {
  PneumaticConfig config = Rig();
  config.initial_pressure_bar = 4.0;
  PneumaticElement element(config);
  element.Reset(0.16);
  const double amount = (4.0 + kAmbientPressure_bar) * element.chamber_volume_m3(0.16);
  double q = 0.16;
  for (int k = 0; k < 6600; ++k) element.Step({}, q -= 1e-4, kGasStep_s);
  EXPECT_NEAR((element.pressure_bar() + kAmbientPressure_bar) * element.chamber_volume_m3(q),
              amount, 1e-15);
  EXPECT_NEAR(element.reservoir_pressure_bar(), 6.0, 1e-12);
}

// The work of the gas equals the work of the model's torque K P - k1 P (q - q0): dV/dq by
// difference.
TEST(Pneumatics, HasAVolumeThatFitsTheTorque) {
  const PneumaticConfig config = Rig();
  const PneumaticElement element(config);
  for (const double q : {0.1, 0.16, 0.2}) {
    const double slope =
        (element.chamber_volume_m3(q + 1e-5) - element.chamber_volume_m3(q - 1e-5)) / 2e-5;
    EXPECT_NEAR(slope * 1e5, 0.36 - 4.0 * (q - 0.16), 1e-6);
  }
}

TEST(Pneumatics, EqualisesThroughTheValveAndLosesNoGas) {
  const PneumaticConfig config = Rig();
  PneumaticElement element(config);
  element.Reset(0.16);
  const double before = (6.0 + kAmbientPressure_bar) * 2e-3 + kAmbientPressure_bar * 1.2e-4;
  RunFor(element, {.valve_open = true}, 0.16, 3.0);
  EXPECT_NEAR(element.pressure_bar(), element.reservoir_pressure_bar(), 1e-6);
  EXPECT_NEAR((element.pressure_bar() + kAmbientPressure_bar) * (2e-3 + 1.2e-4), before, 1e-9);
}

TEST(Pneumatics, LeaksExponentially) {
  PneumaticConfig config = Rig();
  config.initial_pressure_bar = 6.0;
  config.leak_conductance_m3_s = 1.2e-5;  // time constant 10 s
  PneumaticElement element(config);
  element.Reset(0.16);
  RunFor(element, {}, 0.16, 10.0);
  EXPECT_NEAR(element.pressure_bar(), 6.0 * std::exp(-1.0), 1e-6);
}

TEST(Pneumatics, FillsToTheCutOutAndVentsToAmbient) {
  PneumaticConfig config = Rig();
  config.source_pressure_bar = 0.0;
  config.compressor_cut_out_bar = 7.0;
  PneumaticElement element(config);
  element.Reset(0.16);
  RunFor(element, {.compressor_on = true}, 0.16, 5.0);
  EXPECT_NEAR(element.reservoir_pressure_bar(), 4e-4 * 5.0 / 2e-3, 1e-9);
  RunFor(element, {.compressor_on = true}, 0.16, 60.0);
  EXPECT_NEAR(element.reservoir_pressure_bar(), 7.0, 1e-3);
  RunFor(element, {.vent_open = true}, 0.16, 200.0);
  EXPECT_NEAR(element.reservoir_pressure_bar(), 0.0, 1e-6);
}

TEST(Pneumatics, FollowsASourceOfConstantPressure) {
  PneumaticConfig config = Rig();
  config.reservoir_volume_m3 = 0.0;
  config.source_pressure_bar = 4.0;
  PneumaticElement element(config);
  RunFor(element, {.valve_open = true, .vent_open = true}, 0.16, 3.0);
  EXPECT_NEAR(element.pressure_bar(), 4.0, 1e-6);
  EXPECT_EQ(element.reservoir_pressure_bar(), 4.0);
}

TEST(Pneumatics, RefusesWhatCannotBe) {
  PneumaticConfig config = Rig();
  config.chamber_volume_m3 = 0.0;
  EXPECT_THROW(PneumaticElement{config}, std::invalid_argument);
  config = Rig();
  config.leak_conductance_m3_s = -1.0;
  EXPECT_THROW(PneumaticElement{config}, std::invalid_argument);
  config = Rig();
  config.source_pressure_bar = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(PneumaticElement{config}, std::invalid_argument);
}

}  // namespace
}  // namespace sinew::plant
