// Oracle: a rotor integrated with an inertia, damping and dry friction that were put in.
#include "components/model/experiment/motor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

namespace sinew::experiment {
namespace {

constexpr double kInertia = 1.15e-5, kViscous = 3.1e-5;

Recording Rotor(double coulomb_Nm, double duration_s, double noise = 1.0) {
  MotorProtocol protocol({.duration_s = duration_s});
  std::mt19937 random(9);
  std::normal_distribution<double> gauss;
  const RigConstants rig;
  Recording rows;
  double angle = 0.0, w = 0.0;
  Reading reading;
  for (int i = 0; i < static_cast<int>(duration_s * 240.0); ++i) {
    reading.time_s = i / 240.0;
    const double torque_Nm = protocol.Step(reading).motor_torque_Nm;
    constexpr int kSub = 40;
    for (int k = 0; k < kSub; ++k) {
      if (k == kSub / 2) {
        Row row;
        row.time_s = reading.time_s + 0.5 / 240.0;
        row.motor_angle_rad = angle + noise * 2.3e-4 * gauss(random);
        row.motor_velocity_rad_s = w + noise * 0.2 * gauss(random);
        row.motor_current_A = torque_Nm / rig.torque_constant_Nm_A + noise * 0.03 * gauss(random);
        rows.push_back(row);
      }
      const double dt = 1.0 / 240.0 / kSub;
      const double friction = w > 0.0 ? coulomb_Nm : w < 0.0 ? -coulomb_Nm : 0.0;
      w += dt * (torque_Nm - kViscous * w - friction) / kInertia;
      angle += dt * w;
    }
  }
  return rows;
}

TEST(Motor, InertiaDampingAndDryFrictionComeBack) {
  const Result result = IdentifyMotor(Rotor(3e-4, 40.0), {});
  EXPECT_NEAR(result.Find("rotor_inertia_kg_m2")->estimate.value, kInertia, 0.005 * kInertia);
  EXPECT_NEAR(result.Find("rotor_viscous_Nm_s_rad")->estimate.value, kViscous, 0.02 * kViscous);
  EXPECT_NEAR(result.Find("rotor_coulomb_Nm")->estimate.value, 3e-4, 0.6e-4);
}

TEST(Motor, WithoutACoulombTermDampingTakesUpTheDryFriction) {
  const Result result = IdentifyMotor(Rotor(3e-4, 40.0, 0.0), {});
  EXPECT_GT(result.Find("rotor_viscous_published_Nm_s_rad")->estimate.value, 1.03 * kViscous);
  EXPECT_NEAR(result.Find("rotor_viscous_Nm_s_rad")->estimate.value, kViscous, 0.01 * kViscous);
}

TEST(Motor, ACoupledMotorIsRefused) {
  Recording rows = Rotor(0.0, 10.0);
  rows[500].output_angle_rad = 0.2;
  EXPECT_THROW((void)IdentifyMotor(rows, {}), std::invalid_argument);
}

TEST(Motor, AShortRecordingIsRefused) {
  EXPECT_THROW((void)IdentifyMotor(Rotor(0.0, 3.0), {}), std::invalid_argument);
  EXPECT_THROW((void)IdentifyMotor({}, {}), std::invalid_argument);
  EXPECT_THROW(MotorProtocol({.lowest_Hz = 2.0, .highest_Hz = 1.0}), std::invalid_argument);
}

TEST(Motor, TorqueHasTheAskedSizeAndBeginsAndEndsAtNothing) {
  MotorProtocol protocol({.duration_s = 40.0, .torque_Nm = 0.009});
  double sum = 0.0;
  int count = 0;
  for (int i = 0; i < 9600; ++i) {
    const double torque_Nm = protocol.Step({.time_s = i / 240.0}).motor_torque_Nm;
    sum += torque_Nm * torque_Nm;
    ++count;
  }
  EXPECT_NEAR(std::sqrt(sum / count), 0.009, 0.0012);
  EXPECT_EQ(protocol.Step({.time_s = 0.0}).motor_torque_Nm, 0.0);
  (void)protocol.Step({.time_s = 41.0});
  EXPECT_TRUE(protocol.done());
}

}  // namespace
}  // namespace sinew::experiment
