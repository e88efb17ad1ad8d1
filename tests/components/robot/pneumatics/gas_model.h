// A small isothermal gas model of the rig's air for the manager's tests: 2-litre reservoir and
// chamber, relays with dead time, compressor that delivers less against pressure, choked valve and
// vent, 10-bit sensor with noise.
#pragma once

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>
#include <random>

namespace sinew::pneumatics {

struct GasModel {
  double reservoir_m3 = 2e-3;
  double chamber_m3 = 1.2e-4;
  double chamber_bar = 0.0;    // gauge
  double reservoir_bar = 0.0;  // gauge
  double dead_time_s = 0.02;
  double leak_kg_s_bar = 0.0;  // from the chamber, per bar gauge
  // What may break.
  bool valve_stuck_shut = false;
  bool valve_stuck_open = false;
  bool compressor_dead = false;
  bool compressor_stuck_on = false;
  std::optional<double> sensor_override_bar;

  bool valve_is_open = false;
  std::mt19937_64 random{21};
  std::normal_distribution<double> noise{0.0, 0.006};

  static constexpr double kRT = 287.05 * 293.15;  // J/kg
  static constexpr double kAtmosphere_Pa = 101325.0;

  void Step(bool valve, bool compressor, bool vent, double period_s) {
    commands.push_back({valve, compressor, vent});
    const auto delay = static_cast<std::size_t>(std::lround(dead_time_s / period_s)) + 1;
    if (commands.size() > delay) commands.pop_front();
    const Command now = commands.front();
    valve_is_open = (now.valve || valve_stuck_open) && !valve_stuck_shut;
    const bool pumping = (now.compressor || compressor_stuck_on) && !compressor_dead;
    const int steps = 20;
    const double h = period_s / steps;
    for (int i = 0; i < steps; ++i) {
      const double in = pumping ? 7e-4 * std::max(0.0, 1.0 - reservoir_bar / 8.0) : 0.0;
      const double out = now.vent ? 1.2e-4 * reservoir_bar : 0.0;
      const double across = valve_is_open ? 2e-3 * (reservoir_bar - chamber_bar) : 0.0;
      reservoir_bar += 1e-5 * kRT / reservoir_m3 * (in - out - across) * h;
      chamber_bar += 1e-5 * kRT / chamber_m3 * (across - leak_kg_s_bar * chamber_bar) * h;
    }
  }

  // The link moves: closed air keeps p V.
  void SetChamberVolume(double volume_m3) {
    const double atmosphere_bar = 1e-5 * kAtmosphere_Pa;
    if (valve_is_open) {
      const double ratio = (reservoir_m3 + chamber_m3) / (reservoir_m3 + volume_m3);
      chamber_bar = (chamber_bar + atmosphere_bar) * ratio - atmosphere_bar;
      reservoir_bar = (reservoir_bar + atmosphere_bar) * ratio - atmosphere_bar;
    } else {
      chamber_bar = (chamber_bar + atmosphere_bar) * chamber_m3 / volume_m3 - atmosphere_bar;
    }
    chamber_m3 = volume_m3;
  }

  double Sensor() {
    if (sensor_override_bar) return *sensor_override_bar;
    constexpr double kStep_bar = 10.0 / 1024.0;
    return kStep_bar * std::round((chamber_bar + noise(random)) / kStep_bar);
  }

  struct Command {
    bool valve, compressor, vent;
  };
  std::deque<Command> commands;
};

}  // namespace sinew::pneumatics
