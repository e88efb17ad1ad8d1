#include "sim/surrogate/motor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <vector>

namespace sinew::surrogate {
namespace {

constexpr double kStep_s = 1.0 / 24000.0;

TEST(Motor, TorqueConstantIsSixtyOverTwoPiKv) {
  EXPECT_NEAR(MotorParameters{}.torque_constant_Nm_A, 60.0 / (2.0 * std::numbers::pi * 600.0),
              1e-7);
}

TEST(Motor, NoReferenceAtRestGivesNoTorque) {
  Motor motor{MotorParameters{}};
  for (int i = 0; i < 100; ++i) EXPECT_EQ(motor.Step(0.0, 0.0, 0.0, kStep_s), 0.0);
}

TEST(Motor, CurrentFollowsAStepAsAFirstOrderLagOfTheBandwidth) {
  // Pole cancellation makes the closed loop a first-order lag: i = i0 (1 - exp(-bandwidth t)).
  const MotorParameters parameters;
  Motor motor{parameters};
  const double reference_A = 2.0;
  for (int i = 1; i <= 240; ++i) {
    motor.Step(reference_A * parameters.torque_constant_Nm_A, 0.0, 0.0, kStep_s);
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
    torque_Nm = motor.Step(10.0, 0.0, 0.0, kStep_s);
    ASSERT_LE(motor.iq_A(), parameters.current_limit_A * 1.001);
  }
  EXPECT_NEAR(torque_Nm, 25.0 * parameters.torque_constant_Nm_A, 1e-4);
}

TEST(Motor, TurningAtConstantSpeedTheCurrentStillMeetsItsReference) {
  const MotorParameters parameters;
  Motor motor{parameters};
  for (int i = 0; i < 2400; ++i) motor.Step(0.05, 0.0, 300.0, kStep_s);
  EXPECT_NEAR(motor.iq_A(), 0.05 / parameters.torque_constant_Nm_A, 1e-3);
}

TEST(Motor, BusVoltageLimitsTheTorqueAtHighSpeed) {
  const MotorParameters parameters;
  Motor motor{parameters};
  // Speed voltage above bus/sqrt(3): no driving current is possible.
  const double speed_rad_s = 1.1 * parameters.bus_voltage_V / std::numbers::sqrt3 /
                             (parameters.pole_pairs * motor.flux_linkage_Wb());
  double torque_Nm = 0.0;
  for (int i = 0; i < 4800; ++i) torque_Nm = motor.Step(0.2, 0.0, speed_rad_s, kStep_s);
  EXPECT_LT(torque_Nm, 0.0);
}

TEST(Motor, WindingsWarmToTheTemperatureThatTheirLossHolds) {
  MotorParameters parameters;
  parameters.heat_capacity_J_K = 0.01;  // settles in 30 ms
  Motor motor{parameters};
  for (int i = 0; i < 24000; ++i)
    motor.Step(10.0 * parameters.torque_constant_Nm_A, 0.0, 0.0, kStep_s);
  const double loss_W = 1.5 * parameters.resistance_ohm * 100.0;
  EXPECT_NEAR(motor.temperature_degC(),
              parameters.ambient_degC + loss_W * parameters.thermal_resistance_K_W, 0.1);
}

TEST(Motor, PhasesWithASineEmfAreTheMotorInItsRotorFrame) {
  MotorParameters parameters;
  Motor rotor_frame{parameters};
  parameters.three_phase = true;
  Motor phases{parameters};
  const double speed_rad_s = 100.0;
  double angle_rad = 0.3;
  for (int i = 0; i < 4800; ++i) {
    const double reference_Nm = 0.05 * std::sin(2.0 * std::numbers::pi * 10.0 * i * kStep_s);
    const double expected_Nm = rotor_frame.Step(reference_Nm, angle_rad, speed_rad_s, kStep_s);
    const double torque_Nm = phases.Step(reference_Nm, angle_rad, speed_rad_s, kStep_s);
    // The frame turns by 0.03 rad within a step, which the d-q equations take as continuous.
    ASSERT_NEAR(torque_Nm, expected_Nm, 0.02 * 0.05) << i;
    angle_rad += speed_rad_s * kStep_s;
  }
}

TEST(Motor, AFlatEmfRipplesSixTimesAnElectricalTurn) {
  MotorParameters parameters;
  parameters.three_phase = true;
  parameters.emf_flatness = 1.0;
  Motor motor{parameters};
  const double speed_rad_s = 20.0;
  double angle_rad = 0.0, mean_Nm = 0.0;
  constexpr int kCount = 24000;  // a second: 22.3 electrical turns
  std::vector<double> torque_Nm, place_rad;
  for (int i = 0; i < kCount; ++i) {
    const double now_Nm = motor.Step(0.05, angle_rad, speed_rad_s, kStep_s);
    angle_rad += speed_rad_s * kStep_s;
    if (i < 2400) continue;
    torque_Nm.push_back(now_Nm);
    place_rad.push_back(parameters.pole_pairs * angle_rad);
    mean_Nm += now_Nm;
  }
  mean_Nm /= static_cast<double>(torque_Nm.size());
  EXPECT_NEAR(mean_Nm, 0.05, 0.02 * 0.05);
  const auto amplitude_Nm = [&](int order) {
    double sine = 0.0, cosine = 0.0;
    for (std::size_t i = 0; i < torque_Nm.size(); ++i) {
      sine += (torque_Nm[i] - mean_Nm) * std::sin(order * place_rad[i]);
      cosine += (torque_Nm[i] - mean_Nm) * std::cos(order * place_rad[i]);
    }
    return 2.0 * std::hypot(sine, cosine) / static_cast<double>(torque_Nm.size());
  };
  EXPECT_GT(amplitude_Nm(6), 0.01 * 0.05);
  for (const int order : {1, 2, 3, 4, 5, 7, 8}) {
    EXPECT_LT(amplitude_Nm(order), 0.3 * amplitude_Nm(6)) << order;
  }
}

TEST(Motor, RefusesParametersWithoutMeaning) {
  EXPECT_THROW(Motor({.resistance_ohm = 0.0}), std::invalid_argument);
  EXPECT_THROW(Motor({.pole_pairs = 0}), std::invalid_argument);
  EXPECT_THROW(Motor({.inductance_H = std::numeric_limits<double>::quiet_NaN()}),
               std::invalid_argument);
}

}  // namespace
}  // namespace sinew::surrogate
