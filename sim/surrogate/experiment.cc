#include "sim/surrogate/experiment.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "sim/surrogate/random.h"

namespace sinew::surrogate {
namespace {

constexpr std::uint64_t kStreamJitter = 200;
constexpr std::uint64_t kStreamStamp = 201;
constexpr std::uint64_t kStreamLost = 202;
constexpr double kLargestStampError_s = 3e-4;

}  // namespace

std::vector<LogRow> RunExperiment(const RigParameters& parameters, const ExperimentOptions& options,
                                  const CommandFunction& command, const TruthFunction& truth) {
  if (!(options.duration_s > 0.0) || !(options.cycle_Hz > 0.0) || options.log_every < 1 ||
      !(options.jitter_s >= 0.0) || !(options.stamp_error_s >= 0.0) ||
      !(options.lost_share >= 0.0) || !(options.lost_share < 1.0)) {
    throw std::invalid_argument(
        "experiment: duration and rates must be positive, shares in [0, 1)");
  }
  Surrogate surrogate(parameters);
  RandomStream jitter(options.seed, kStreamJitter);
  RandomStream stamp(options.seed, kStreamStamp);
  RandomStream lost(options.seed, kStreamLost);
  const double cycle_s = 1.0 / options.cycle_Hz;
  const auto cycles =
      static_cast<std::int64_t>(std::floor(options.duration_s * options.cycle_Hz + 0.5));

  provider::PlantSensors sensors;
  provider::PlantCommand plant_command;
  provider::Disturbance disturbance;
  surrogate.Reset(&sensors);
  std::vector<LogRow> rows;
  rows.reserve(static_cast<std::size_t>(cycles / options.log_every + 1));
  double instant_s = 0.0;
  for (std::int64_t cycle = 0; cycle < cycles; ++cycle) {
    if (options.done && options.done()) break;
    const double nominal_s = static_cast<double>(cycle) * cycle_s;
    plant_command = provider::PlantCommand{};
    disturbance = provider::Disturbance{};
    command(nominal_s, sensors, &plant_command, &disturbance);
    surrogate.Disturb(disturbance);
    const double late_s =
        std::clamp(options.jitter_s * jitter.Gaussian(), -cycle_s / 3.0, cycle_s / 3.0);
    const double next_s = std::max(nominal_s + cycle_s + late_s, instant_s + 0.1 * cycle_s);
    surrogate.Step(plant_command, next_s - instant_s, &sensors);
    const double latched_s = next_s - 1e-6 * sensors.age_us[0];
    instant_s = next_s;
    if (truth) truth(surrogate.rig().truth());
    if ((cycle + 1) % options.log_every != 0) continue;
    const double stamp_error_s = std::clamp(options.stamp_error_s * stamp.Gaussian(),
                                            -kLargestStampError_s, kLargestStampError_s);
    if (lost.Uniform() < options.lost_share) continue;
    LogRow row;
    row.time_s = latched_s + stamp_error_s;
    row.motor_angle_rad = sensors.motor_position_rad[0];
    row.motor_velocity_rad_s = sensors.motor_velocity_rad_s[0];
    row.output_angle_rad = sensors.position_rad[0];
    row.output_velocity_rad_s = sensors.velocity_rad_s[0];
    row.motor_current_A = sensors.motor_current_A[0];
    row.chamber_pressure_bar = sensors.chamber_pressure_bar[0];
    row.load_force_N = sensors.load_force_N[0];
    row.valve_open = sensors.valve_open[0];
    row.payload_kg = sensors.declared_payload_kg[0];
    row.motor_temperature_degC = sensors.motor_temperature_degC[0];
    row.reservoir_pressure_bar = sensors.reservoir_pressure_bar[0];
    rows.push_back(row);
  }
  return rows;
}

}  // namespace sinew::surrogate
