// The recorded channels: counts, noise, stamps, lost rows.
#pragma once

#include <vector>

#include "bench/rigs/drawn/plant.h"
#include "bench/rigs/drawn/rig.h"

namespace sinew::rigs {

// Readings of one row. `index` is the row's place on the true time grid.
struct Reading {
  int index = 0;
  double time_s = 0.0;
  double motor_rad = 0.0;  // motor angle
  double motor_velocity_rad_s = 0.0;
  double position = 0.0, velocity = 0.0;
  double drive = 0.0, supply_V = 0.0;
  double pressure_bar = 0.0, load_force_N = 0.0, payload_kg = 0.0, temperature_degC = 0.0;
  double reference = 0.0;
  bool valve_open = false;
  double tooth_force = 0.0;  // truth, for the encoders' balance
};

// Without noise: exact readings of every row.
std::vector<Reading> ReadExactly(const Rig& rig, const std::vector<TrueRow>& rows);
// With noise. The seeds depend on the rig and the recording alone, so that a twin without an effect
// has the same noise.
std::vector<Reading> ReadWithNoise(const Rig& rig, const std::vector<TrueRow>& rows, int recording);

}  // namespace sinew::rigs
