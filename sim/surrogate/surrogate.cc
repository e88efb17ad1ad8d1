#include "sim/surrogate/surrogate.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "components/base/types/joints.h"
#include "components/base/types/signal.h"

namespace sinew::surrogate {
namespace {

constexpr double kLargestForce_N = 500.0;
constexpr double kLargestPayload_kg = 20.0;
constexpr double kLargestAngle_rad = 100.0;
constexpr double kLargestVelocity_rad_s = 100.0;
// As initial_pressure_bar (rig.cc): near vacuum, and what the chamber's sensor range doubles to.
constexpr double kLowestPressure_bar = -0.9;
constexpr double kLargestPressure_bar = 20.0;

bool IsFinite(const RigReading& reading) {
  return std::isfinite(reading.output_angle_rad) && std::isfinite(reading.output_velocity_rad_s) &&
         std::isfinite(reading.motor_angle_rad) && std::isfinite(reading.motor_velocity_rad_s) &&
         std::isfinite(reading.motor_current_A) && std::isfinite(reading.motor_temperature_degC) &&
         std::isfinite(reading.chamber_pressure_bar) &&
         std::isfinite(reading.reservoir_pressure_bar);
}

}  // namespace

Surrogate::Surrogate(const RigParameters& parameters, int joints) {
  if (joints < 1 || joints > types::kMaxJoints) {
    throw std::invalid_argument(std::to_string(joints) + " joints, expected 1 to " +
                                std::to_string(types::kMaxJoints));
  }
  RigParameters next = parameters;
  for (int j = 0; j < joints; ++j, ++next.seed) rigs_.emplace_back(next);
}

std::uint32_t Surrogate::measured_flags() const {
  return types::kMotorSignals | types::kOutputSignals | types::SignalBit(types::Signal::kPayload);
}

void Surrogate::Reset(provider::PlantSensors* sensors) {
  refused_commands_ = 0;
  disturbance_ = {};
  pressure_ = {};
  truth_ = {};
  *sensors = provider::PlantSensors{};
  for (std::size_t j = 0; j < rigs_.size(); ++j) {
    rigs_[j].Reset();
    Fill(j, Read(j), 0.0, sensors);
  }
}

void Surrogate::Step(const provider::PlantCommand& command, double period_s,
                     provider::PlantSensors* sensors) {
  bool finite = true, diverged = false;
  for (std::size_t j = 0; j < rigs_.size(); ++j) {
    finite = StepRig(j, command, period_s, sensors, &diverged) && finite;
  }
  if (diverged) {
    sensors->fault = true;
    sensors->message = "the simulation has diverged and begins anew";
  } else if (!finite) {
    ++refused_commands_;
    sensors->fault = true;
    sensors->message = "command with a value that is not finite: drive idles";
  } else if (sensors->fault) {
    sensors->fault = false;
    sensors->message.clear();
  }
}

bool Surrogate::StepRig(std::size_t joint, const provider::PlantCommand& command, double period_s,
                        provider::PlantSensors* sensors, bool* diverged) {
  Rig& rig = rigs_[joint];
  const double force_N = disturbance_.hand_force_N[joint];
  const double payload_kg = disturbance_.extra_payload_kg[joint];
  const double ratio = rig.parameters().gear.ratio;
  const bool finite = std::isfinite(command.motor_torque_Nm[joint]) &&
                      std::isfinite(command.position_rad[joint]) &&
                      std::isfinite(command.velocity_rad_s[joint]) && std::isfinite(force_N) &&
                      std::isfinite(payload_kg);
  RigInput input;
  input.valve_open = command.valve_open[joint];
  input.compressor_on = command.compressor_on[joint];
  input.vent_open = command.vent_open[joint];
  const double imposed_bar = pressure_.chamber_pressure_bar[joint];
  input.pressure_imposed = pressure_.imposed[joint] && std::isfinite(imposed_bar);
  if (input.pressure_imposed) {
    input.imposed_pressure_bar = std::clamp(imposed_bar, kLowestPressure_bar, kLargestPressure_bar);
  }
  if (finite) {
    input.drive.mode = command.mode[joint];
    input.drive.torque_Nm = command.motor_torque_Nm[joint];
    input.drive.position_rad =
        ratio * std::clamp(command.position_rad[joint], -kLargestAngle_rad, kLargestAngle_rad);
    input.drive.velocity_rad_s =
        ratio *
        std::clamp(command.velocity_rad_s[joint], -kLargestVelocity_rad_s, kLargestVelocity_rad_s);
    input.hand_force_N = std::clamp(force_N, -kLargestForce_N, kLargestForce_N);
    input.extra_payload_kg = std::clamp(payload_kg, 0.0, kLargestPayload_kg);
  }
  if (!(period_s > 0.0) || !std::isfinite(period_s)) return finite;
  const double until_latch_s = rig.parameters().sensors.latch_phase * period_s;
  rig.Advance(input, until_latch_s);
  RigReading reading = Read(joint);
  if (!IsFinite(reading)) {
    *diverged = true;
    rig.Reset();
    reading = Read(joint);
  }
  rig.Advance(input, period_s - until_latch_s);
  Fill(joint, reading, period_s - until_latch_s, sensors);
  return finite;
}

RigReading Surrogate::Read(std::size_t joint) noexcept {
  Rig& rig = rigs_[joint];
  const RigTruth truth = rig.truth();
  truth_.contact[joint] = truth.contact;
  truth_.play_angle_rad[joint] = truth.motor_angle_rad / rig.parameters().gear.ratio -
                                 truth.output_angle_rad + 0.5 * truth.play_rad;
  truth_.backlash_rad[joint] = truth.play_rad;
  return rig.Read();
}

void Surrogate::Fill(std::size_t joint, const RigReading& reading, double age_s,
                     provider::PlantSensors* sensors) {
  sensors->position_rad[joint] = reading.output_angle_rad;
  sensors->velocity_rad_s[joint] = reading.output_velocity_rad_s;
  sensors->torque_Nm[joint] = reading.output_torque_Nm;
  sensors->motor_position_rad[joint] = reading.motor_angle_rad;
  sensors->motor_velocity_rad_s[joint] = reading.motor_velocity_rad_s;
  sensors->motor_current_A[joint] = reading.motor_current_A;
  sensors->drive_voltage_V[joint] = reading.drive_voltage_V;
  sensors->motor_temperature_degC[joint] = reading.motor_temperature_degC;
  sensors->chamber_pressure_bar[joint] = reading.chamber_pressure_bar;
  sensors->reservoir_pressure_bar[joint] = reading.reservoir_pressure_bar;
  sensors->load_force_N[joint] = reading.load_force_N;
  sensors->declared_payload_kg[joint] = reading.declared_payload_kg;
  sensors->valve_open[joint] = reading.valve_open;
  sensors->age_us[joint] = static_cast<std::int32_t>(std::lround(1e6 * age_s));
  sensors->valid[joint] = true;
}

}  // namespace sinew::surrogate
