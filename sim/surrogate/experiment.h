// Running the surrogate in process, without topics: a command function in, the lab's rows out.
//
// Rows are taken every log_every cycles. As in the lab, a cycle does not come exactly on time
// (jitter), the row's stamp has a small error of its own, and some rows never arrive. All of it
// from the seed. Not for loops in real time: rows are collected in a vector.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "components/robot/provider/simulated_plant.h"
#include "sim/surrogate/surrogate.h"

namespace sinew::surrogate {

struct LogRow {
  double time_s = 0.0;
  double motor_angle_rad = 0.0;
  double motor_velocity_rad_s = 0.0;
  double output_angle_rad = 0.0;
  double output_velocity_rad_s = 0.0;
  double motor_current_A = 0.0;
  double chamber_pressure_bar = 0.0;
  double load_force_N = 0.0;
  bool valve_open = false;
  double payload_kg = 0.0;
  double motor_temperature_degC = 0.0;
  double reservoir_pressure_bar = 0.0;
};

struct ExperimentOptions {
  double duration_s = 90.0;
  double cycle_Hz = 240.0;
  int log_every = 3;       // cycles per row: 80 Hz
  double jitter_s = 4e-4;  // of a cycle's instant, standard deviation, cut at a third of a cycle
  double stamp_error_s = 1e-4;  // of a row's stamp, standard deviation, cut at 3e-4 s
  double lost_share = 0.004;    // of rows
  std::uint64_t seed = 1;
  std::function<bool()> done = {};  // ends the run early, asked before every cycle; may be empty
};

// Called at the start of every cycle with the newest readings; command and disturbance are empty
// then. nominal_time_s counts whole cycles.
using CommandFunction =
    std::function<void(double nominal_time_s, const provider::PlantSensors& sensors,
                       provider::PlantCommand* command, provider::Disturbance* disturbance)>;
// Sees the truth after every cycle; may be empty.
using TruthFunction = std::function<void(const RigTruth& truth)>;

// Throws std::invalid_argument.
std::vector<LogRow> RunExperiment(const RigParameters& parameters, const ExperimentOptions& options,
                                  const CommandFunction& command, const TruthFunction& truth = {});

}  // namespace sinew::surrogate
