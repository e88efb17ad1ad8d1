#include "sim/surrogate/motor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace sinew::surrogate {
namespace {

constexpr double kStep_s = 1.0 / 24000.0;

TEST(Motor, TorqueConstantIsSixtyOverTwoPiKv) {
  EXPECT_NEAR(MotorParameters{}.torque_constant_Nm_A, 60.0 / (2.0 * std::numbers::pi * 600.0),
              1e-7);
}

TEST(Motor, NoReferenceAtRestGivesNoTorque) {
  Motor motor{MotorParameters{}};
  for (int i = 0; i < 100; ++i) EXPECT_EQ(motor.Step(0.0, 0.0, kStep_s), 0.0);
}

TEST(Motor, CurrentFollowsAStepAsAFirstOrderLagOfTheBandwidth) {
  // Pole cancellation makes the closed loop a first-order lag: i = i0 (1 - exp(-bandwidth t)).
  const MotorParameters parameters;
  Motor motor{parameters};
  const double reference_A = 2.0;
  for (int i = 1; i <= 240; ++i) {
    motor.Step(reference_A * parameters.torque_constant_Nm_A, 0.0, kStep_s);
    const double expected_A =
        reference_A * (1.0 - std::exp(-parameters.current_bandwidth_rad_s * i * kStep_s));
    // Explicit steps of 1/24 of the time constant: within 2 % of the final value.
    ASSERT_NEAR(motor.iq_A(), expected_A, 0.02 * reference_A) << i;
  }
  EXPECT_NEAR(motor.id_A(), 0.0, 1e-9);
}

TEST(Motor, CurrentNeverPassesItsLimit) {
  const MotorParameters parameters;
  Motor motor{parameters};
  double torque_Nm = 0.0;
  for (int i = 0; i < 2400; ++i) {
    torque_Nm = motor.Step(10.0, 0.0, kStep_s);
    ASSERT_LE(motor.iq_A(), parameters.current_limit_A * 1.001);
  }
  EXPECT_NEAR(torque_Nm, 25.0 * parameters.torque_constant_Nm_A, 1e-4);
}

TEST(Motor, TurningAtConstantSpeedTheCurrentStillMeetsItsReference) {
  const MotorParameters parameters;
  Motor motor{parameters};
  for (int i = 0; i < 2400; ++i) motor.Step(0.05, 300.0, kStep_s);
  EXPECT_NEAR(motor.iq_A(), 0.05 / parameters.torque_constant_Nm_A, 1e-3);
}

TEST(Motor, BusVoltageLimitsTheTorqueAtHighSpeed) {
  const MotorParameters parameters;
  Motor motor{parameters};
  // Speed voltage above bus/sqrt(3): no driving current is possible.
  const double speed_rad_s = 1.1 * parameters.bus_voltage_V / std::numbers::sqrt3 /
                             (parameters.pole_pairs * motor.flux_linkage_Wb());
  double torque_Nm = 0.0;
  for (int i = 0; i < 4800; ++i) torque_Nm = motor.Step(0.2, speed_rad_s, kStep_s);
  EXPECT_LT(torque_Nm, 0.0);
}

TEST(Motor, WindingsWarmToTheTemperatureThatTheirLossHolds) {
  MotorParameters parameters;
  parameters.heat_capacity_J_K = 0.01;  // settles in 30 ms
  Motor motor{parameters};
  for (int i = 0; i < 24000; ++i) motor.Step(10.0 * parameters.torque_constant_Nm_A, 0.0, kStep_s);
  const double loss_W = 1.5 * parameters.resistance_ohm * 100.0;
  EXPECT_NEAR(motor.temperature_degC(),
              parameters.ambient_degC + loss_W * parameters.thermal_resistance_K_W, 0.1);
}

TEST(Motor, RefusesParametersWithoutMeaning) {
  EXPECT_THROW(Motor({.resistance_ohm = 0.0}), std::invalid_argument);
  EXPECT_THROW(Motor({.pole_pairs = 0}), std::invalid_argument);
  EXPECT_THROW(Motor({.inductance_H = std::numeric_limits<double>::quiet_NaN()}),
               std::invalid_argument);
}

}  // namespace
}  // namespace sinew::surrogate
