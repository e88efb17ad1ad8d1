#include "sim/plant/pneumatics.h"

#include <algorithm>
#include <cmath>

#include "components/base/types/require.h"

namespace sinew::plant {

namespace {

constexpr double kSmallestVolume_share =
    0.05;  // of the volume at the rest angle: the rotor's end stop

}  // namespace

PneumaticElement::PneumaticElement(const PneumaticConfig& config) : config_(config) {
  const auto not_negative = [](const char* what, double value) {
    types::Require(value >= 0.0, what, value, "at least 0");
  };
  types::Require(config.chamber_volume_m3 > 0.0, "chamber_volume_m3", config.chamber_volume_m3,
                 "above 0");
  not_negative("reservoir_volume_m3", config.reservoir_volume_m3);
  not_negative("valve_conductance_m3_s", config.valve_conductance_m3_s);
  not_negative("leak_conductance_m3_s", config.leak_conductance_m3_s);
  not_negative("vent_conductance_m3_s", config.vent_conductance_m3_s);
  not_negative("compressor_flow_bar_m3_s", config.compressor_flow_bar_m3_s);
  not_negative("source_pressure_bar", config.source_pressure_bar);
  not_negative("initial_pressure_bar", config.initial_pressure_bar);
  Reset(config.rest_angle_rad);
}

double PneumaticElement::chamber_volume_m3(double position_rad) const noexcept {
  const double turned = position_rad - config_.rest_angle_rad;
  const double volume = config_.chamber_volume_m3 +
                        1e-5 * (config_.torque_slope_Nm_bar * turned -
                                0.5 * config_.stiffness_slope_Nm_rad_bar * turned * turned);
  return std::max(volume, kSmallestVolume_share * config_.chamber_volume_m3);
}

void PneumaticElement::Reset(double position_rad) {
  pressure_bar_ = config_.initial_pressure_bar;
  reservoir_pressure_bar_ = config_.source_pressure_bar;
  pressure_rate_bar_s_ = 0.0;
  chamber_bar_m3_ = (pressure_bar_ + kAmbientPressure_bar) * chamber_volume_m3(position_rad);
  reservoir_bar_m3_ =
      (reservoir_pressure_bar_ + kAmbientPressure_bar) * config_.reservoir_volume_m3;
}

void PneumaticElement::Step(const Relays& relays, double position_rad, double dt_s,
                            double extra_rate_bar_s) noexcept {
  const double volume = chamber_volume_m3(position_rad);
  chamber_bar_m3_ += volume * extra_rate_bar_s * dt_s;
  const double reservoir_volume = config_.reservoir_volume_m3;
  double chamber = chamber_bar_m3_ / volume;  // absolute, after the motion
  double reservoir = reservoir_pressure_bar_ + kAmbientPressure_bar;
  if (relays.valve_open) {
    // Two volumes through one conductance: the difference decays exponentially.
    const double conductance = config_.valve_conductance_m3_s;
    if (reservoir_volume > 0.0) {
      const double together = 1.0 / (1.0 / volume + 1.0 / reservoir_volume);
      const double moved =
          together * (reservoir - chamber) * -std::expm1(-conductance * dt_s / together);
      chamber_bar_m3_ += moved;
      reservoir_bar_m3_ -= moved;
    } else {
      chamber_bar_m3_ += volume * (reservoir - chamber) * -std::expm1(-conductance * dt_s / volume);
    }
  }
  if (config_.leak_conductance_m3_s > 0.0) {
    chamber = chamber_bar_m3_ / volume;
    chamber_bar_m3_ += volume * (kAmbientPressure_bar - chamber) *
                       -std::expm1(-config_.leak_conductance_m3_s * dt_s / volume);
  }
  if (reservoir_volume > 0.0) {
    if (relays.compressor_on && reservoir_pressure_bar_ < config_.compressor_cut_out_bar) {
      reservoir_bar_m3_ += config_.compressor_flow_bar_m3_s * dt_s;
    }
    if (relays.vent_open) {
      reservoir = reservoir_bar_m3_ / reservoir_volume;
      reservoir_bar_m3_ += reservoir_volume * (kAmbientPressure_bar - reservoir) *
                           -std::expm1(-config_.vent_conductance_m3_s * dt_s / reservoir_volume);
    }
    reservoir_pressure_bar_ = reservoir_bar_m3_ / reservoir_volume - kAmbientPressure_bar;
  }
  const double pressure = chamber_bar_m3_ / volume - kAmbientPressure_bar;
  pressure_rate_bar_s_ = (pressure - pressure_bar_) / dt_s;
  pressure_bar_ = pressure;
}

void PneumaticElement::Impose(double pressure_bar, double position_rad) noexcept {
  pressure_rate_bar_s_ = 0.0;
  pressure_bar_ = pressure_bar;
  chamber_bar_m3_ = (pressure_bar + kAmbientPressure_bar) * chamber_volume_m3(position_rad);
}

}  // namespace sinew::plant
