// The plant of a state provider: world, surrogate, or hardware behind the CAN bridge. Simulations
// implement SimulatedPlant (simulated_plant.h). Called by one thread.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <string>

#include "components/base/types/control_mode.h"
#include "components/base/types/fault.h"
#include "components/base/types/joints.h"

namespace sinew::provider {

// The command that the guard lets through to the plant for one cycle.
struct PlantCommand {
  types::JointArray<types::ControlMode> mode{};
  types::JointArray<double> motor_torque_Nm{};  // motor shaft, positive drives the output up
  types::JointArray<double> position_rad{};     // output
  types::JointArray<double> velocity_rad_s{};   // output
  types::JointArray<bool> valve_open{};
  types::JointArray<bool> compressor_on{};
  types::JointArray<bool> vent_open{};
};

// Readings of the sensors at the end of a cycle. Units and signs as in idl/.
struct PlantSensors {
  types::JointArray<double> position_rad{};
  types::JointArray<double> velocity_rad_s{};
  types::JointArray<double> torque_Nm{};
  types::JointArray<double> motor_position_rad{};
  types::JointArray<double> motor_velocity_rad_s{};
  types::JointArray<double> motor_current_A{};
  types::JointArray<double> drive_voltage_V{};
  types::JointArray<double> motor_temperature_degC{};
  types::JointArray<double> chamber_pressure_bar{};
  types::JointArray<double> reservoir_pressure_bar{};
  types::JointArray<double> load_force_N{};
  types::JointArray<double> declared_payload_kg{};
  types::JointArray<bool> valve_open{};
  types::JointArray<std::int32_t> age_us{};
  types::JointArray<bool> valid{};
  // A joint's own fault: it idles until the operator's reset; the others follow the guard's policy
  // for the other joints (guard.h).
  types::JointArray<types::Fault> joint_fault{};
  bool fault = false;   // of the whole plant
  std::string message;  // why

  bool any_fault() const {
    return fault || std::any_of(joint_fault.begin(), joint_fault.end(),
                                [](const types::Fault& joint) { return joint.active(); });
  }
};

// Health of field buses; only a bridge has it.
struct BusReport {
  static constexpr int kMaxBuses = 4;
  int bus_count = 0;
  std::array<bool, kMaxBuses> up{};
  std::array<std::uint64_t, kMaxBuses> frames_sent{};
  std::array<std::uint64_t, kMaxBuses> frames_received{};
  std::array<std::uint64_t, kMaxBuses> frames_dropped{};
  std::array<std::uint64_t, kMaxBuses> frames_lost{};
  std::array<std::uint64_t, kMaxBuses> error_frames{};
  // Counts of nodes in feet and torso, since the start: samples that never came, losses of a node.
  std::array<std::uint64_t, kMaxBuses> body_samples_missed{};
  std::array<std::uint64_t, kMaxBuses> body_nodes_lost{};
  std::array<double, kMaxBuses> load_percent{};
  std::array<double, kMaxBuses> answer_p50_us{};
  std::array<double, kMaxBuses> answer_max_us{};
  double cycle_p50_us = 0.0;
  double cycle_max_us = 0.0;
};

// Sensors of the body; only a robot with feet and torso has them. Order as in idl/sensors.idl.
struct BodySensors {
  std::array<double, 8> foot_force_N{};
  std::array<bool, 8> foot_valid{};
  std::array<double, 3> acceleration_m_s2{};
  std::array<double, 3> angular_velocity_rad_s{};
  std::array<double, 4> orientation_wxyz{1.0, 0.0, 0.0, 0.0};
  bool imu_valid = false;
};

class Plant {
 public:
  virtual ~Plant() = default;
  virtual int joint_count() const = 0;
  virtual bool prismatic(int /*joint*/) const { return false; }
  virtual std::string joint_name(int /*joint*/) const { return ""; }  // empty: it has none
  virtual bool live() const { return false; }  // hardware: commands must have origin live
  // Why this plant may not be armed, found before the start; empty: it may.
  virtual std::string ArmRefusal() const { return ""; }
  virtual std::uint32_t measured_flags() const = 0;  // bit per types::Signal
  // Sensors at the start, before any command.
  virtual void Reset(PlantSensors* sensors) = 0;
  // Applies the command for one period and reads the sensors at its end.
  virtual void Step(const PlantCommand& command, double period_s, PlantSensors* sensors) = 0;
  // True for hardware, which acts as soon as it has a command: in real time the provider calls Act
  // as soon as the cycle's command has arrived (at the latest in the middle of the period), and the
  // Step that ends the cycle only reads the sensors.
  virtual bool acts_at_once() const { return false; }
  virtual void Act(const PlantCommand& /*command*/, double /*period_s*/) {}
  // The operator's reset: faults that can be cleared are, before the next Step.
  virtual void ClearFault() {}
  // Motors off, relays off, on their way before this returns. The provider calls it as soon as its
  // loop has ended, whatever ended it, before any part of DDS is torn down.
  virtual void ShutDown() noexcept {}
  // Time at which the drive whose report is the oldest reported that it is idle, CLOCK_MONOTONIC;
  // 0: one has not. A simulation's are idle at once.
  virtual std::int64_t idle_reported_ns() const { return std::numeric_limits<std::int64_t>::max(); }
  virtual const BusReport* bus_report() const { return nullptr; }
  virtual const BodySensors* body_sensors() const { return nullptr; }
};

}  // namespace sinew::provider
