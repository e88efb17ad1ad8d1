// The smallest plant that moves: rotors with inertia and viscous drag, rigidly geared. Closed form
// enough for a test.
#pragma once

#include <array>
#include <cmath>
#include <optional>

#include "components/base/types/control_mode.h"
#include "components/base/types/joints.h"
#include "components/robot/provider/simulated_plant.h"

namespace sinew::test {

class Rotors : public provider::SimulatedPlant {
 public:
  explicit Rotors(int joints, double gear_ratio = 100.0)
      : joints_(joints), gear_ratio_(gear_ratio) {}

  static constexpr double kInertia_kg_m2 = 1e-5;  // at the motor shaft
  static constexpr double kDrag_Nm_s_rad = 2e-5;
  static constexpr double kTorqueConstant_Nm_A = 0.0159155;

  int joint_count() const override { return joints_; }
  std::uint32_t measured_flags() const override { return 0; }
  const provider::BodySensors* body_sensors() const override { return body ? &*body : nullptr; }
  void Reset(provider::PlantSensors* sensors) override { Read(sensors); }
  void Disturb(const provider::Disturbance& d) override { disturbance = d; }
  void ImposePressure(const provider::ImposedPressure&) override {}
  const provider::GearTruth& gear_truth() const override { return truth; }
  void Step(const provider::PlantCommand& command, double period_s,
            provider::PlantSensors* sensors) override {
    constexpr int kSteps = 10;
    for (std::size_t j = 0; j < static_cast<std::size_t>(joints_); ++j) {
      for (int i = 0; i < kSteps; ++i) {
        const double dt_s = period_s / kSteps;
        double torque = 0.0;
        switch (command.mode[j]) {
          case types::ControlMode::kIdle:
            break;
          case types::ControlMode::kTorque:
            torque = command.motor_torque_Nm[j];
            break;
          case types::ControlMode::kPosition:
            torque = 5e-3 * (gear_ratio_ * command.position_rad[j] - angle_rad[j]) -
                     4e-4 * velocity_rad_s[j];
            break;
          case types::ControlMode::kVelocity:
            torque = 2e-3 * (gear_ratio_ * command.velocity_rad_s[j] - velocity_rad_s[j]);
            break;
        }
        torque_Nm[j] = torque;
        velocity_rad_s[j] += dt_s * (torque - kDrag_Nm_s_rad * velocity_rad_s[j]) / kInertia_kg_m2;
        angle_rad[j] += dt_s * velocity_rad_s[j];
      }
    }
    last_command = command;
    Read(sensors);
  }

  // At the motor shaft.
  types::JointArray<double> angle_rad{};
  types::JointArray<double> velocity_rad_s{};
  types::JointArray<double> torque_Nm{};
  types::JointArray<double> pressure_bar{};
  types::JointArray<double> temperature_degC{};
  std::optional<provider::BodySensors> body;
  provider::PlantCommand last_command;
  provider::Disturbance disturbance;  // kept for tests; the rotors have no links to push
  provider::GearTruth truth;          // rigid gears

 private:
  void Read(provider::PlantSensors* sensors) const {
    for (std::size_t j = 0; j < static_cast<std::size_t>(joints_); ++j) {
      sensors->motor_position_rad[j] = angle_rad[j];
      sensors->motor_velocity_rad_s[j] = velocity_rad_s[j];
      sensors->motor_current_A[j] = torque_Nm[j] / kTorqueConstant_Nm_A;
      sensors->position_rad[j] = angle_rad[j] / gear_ratio_;
      sensors->velocity_rad_s[j] = velocity_rad_s[j] / gear_ratio_;
      sensors->chamber_pressure_bar[j] = pressure_bar[j];
      sensors->motor_temperature_degC[j] = temperature_degC[j];
      sensors->valve_open[j] = last_command.valve_open[j];
      sensors->valid[j] = true;
    }
  }

  int joints_;
  double gear_ratio_;
};

}  // namespace sinew::test
