#include "sim/surrogate/surrogate.h"

#include <algorithm>
#include <cmath>

namespace sinew::surrogate {
namespace {

constexpr double kLargestForce_N = 500.0;
constexpr double kLargestPayload_kg = 20.0;
constexpr double kLargestAngle_rad = 100.0;
constexpr double kLargestVelocity_rad_s = 100.0;

// Bits of identify::Signal, whose header this room does not include on purpose; a test compares
// them.
enum SignalBit : std::uint32_t {
  kPosition = 1u << 0,
  kVelocity = 1u << 1,
  kMotorPosition = 1u << 2,
  kMotorVelocity = 1u << 3,
  kMotorCurrent = 1u << 4,
  kChamberPressure = 1u << 7,
  kReservoirPressure = 1u << 8,
  kLoadForce = 1u << 9,
  kValveOpen = 1u << 10,
  kPayload = 1u << 11,
  kTemperature = 1u << 12,
};

}  // namespace

Surrogate::Surrogate(const RigParameters& parameters) : rig_(parameters) {}

std::uint32_t Surrogate::measured_flags() const {
  return kPosition | kVelocity | kMotorPosition | kMotorVelocity | kMotorCurrent |
         kChamberPressure | kReservoirPressure | kLoadForce | kValveOpen | kPayload | kTemperature;
}

void Surrogate::Reset(provider::PlantSensors* sensors) {
  rig_.Reset();
  refused_commands_ = 0;
  *sensors = provider::PlantSensors{};
  Fill(rig_.Read(), 0.0, sensors);
}

void Surrogate::Step(const provider::PlantCommand& command, double period_s,
                     provider::PlantSensors* sensors) {
  const double ratio = rig_.parameters().gear.ratio;
  const bool finite =
      std::isfinite(command.motor_torque_Nm[0]) && std::isfinite(command.position_rad[0]) &&
      std::isfinite(command.velocity_rad_s[0]) && std::isfinite(command.hand_force_N[0]) &&
      std::isfinite(command.extra_payload_kg[0]);
  RigInput input;
  input.valve_open = command.valve_open[0];
  input.compressor_on = command.compressor_on[0];
  input.vent_open = command.vent_open[0];
  if (finite) {
    switch (command.mode[0]) {
      case provider::Mode::kIdle:
        input.drive.mode = DriveMode::kIdle;
        break;
      case provider::Mode::kTorque:
        input.drive.mode = DriveMode::kTorque;
        break;
      case provider::Mode::kPosition:
        input.drive.mode = DriveMode::kPosition;
        break;
      case provider::Mode::kVelocity:
        input.drive.mode = DriveMode::kVelocity;
        break;
    }
    input.drive.torque_Nm = command.motor_torque_Nm[0];
    input.drive.position_rad =
        ratio * std::clamp(command.position_rad[0], -kLargestAngle_rad, kLargestAngle_rad);
    input.drive.velocity_rad_s =
        ratio *
        std::clamp(command.velocity_rad_s[0], -kLargestVelocity_rad_s, kLargestVelocity_rad_s);
    input.hand_force_N = std::clamp(command.hand_force_N[0], -kLargestForce_N, kLargestForce_N);
    input.extra_payload_kg = std::clamp(command.extra_payload_kg[0], 0.0, kLargestPayload_kg);
    if (sensors->fault) {
      sensors->fault = false;
      sensors->message.clear();
    }
  } else {
    ++refused_commands_;
    sensors->fault = true;
    sensors->message = "command with a value that is not finite: drive idles";
  }
  if (!(period_s > 0.0) || !std::isfinite(period_s)) return;
  const double until_latch_s = rig_.parameters().sensors.latch_phase * period_s;
  rig_.Advance(input, until_latch_s);
  const RigReading reading = rig_.Read();
  rig_.Advance(input, period_s - until_latch_s);
  Fill(reading, period_s - until_latch_s, sensors);
}

void Surrogate::Fill(const RigReading& reading, double age_s, provider::PlantSensors* sensors) {
  sensors->position_rad[0] = reading.output_angle_rad;
  sensors->velocity_rad_s[0] = reading.output_velocity_rad_s;
  sensors->torque_Nm[0] = reading.output_torque_Nm;
  sensors->motor_position_rad[0] = reading.motor_angle_rad;
  sensors->motor_velocity_rad_s[0] = reading.motor_velocity_rad_s;
  sensors->motor_current_A[0] = reading.motor_current_A;
  sensors->drive_voltage_V[0] = reading.drive_voltage_V;
  sensors->motor_temperature_degC[0] = reading.motor_temperature_degC;
  sensors->chamber_pressure_bar[0] = reading.chamber_pressure_bar;
  sensors->reservoir_pressure_bar[0] = reading.reservoir_pressure_bar;
  sensors->load_force_N[0] = reading.load_force_N;
  sensors->declared_payload_kg[0] = reading.declared_payload_kg;
  sensors->valve_open[0] = reading.valve_open;
  sensors->age_us[0] = static_cast<std::int32_t>(std::lround(1e6 * age_s));
  sensors->valid[0] = true;
}

}  // namespace sinew::surrogate
