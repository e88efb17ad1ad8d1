#include "bench/rigs/drawn/gas.h"

#include <algorithm>
#include <cmath>

namespace sinew::rigs {
namespace {
constexpr double kR = 287.05, kCv = 717.6, kCp = 1004.65;
constexpr double kWall_K = 293.15;
constexpr double kAtmosphere_bar = 1.01325;
constexpr double kChoked = 0.0404;  // sqrt(kg K / J), air
constexpr double kCriticalRatio = 0.35;

// Mass flow through an orifice into the chamber, negative outwards.
double Flow(double area_m2, double outside, double inside, double source_K) noexcept {
  const bool in = outside > inside;
  const double up = in ? outside : inside, down = in ? inside : outside;
  const double over = std::max(0.0, (down / up - kCriticalRatio) / (1.0 - kCriticalRatio));
  // Linear within the last 2 % of pressure, where the root would chatter.
  const double ratio = 1.0 - down / up;
  const double shape =
      ratio < 0.02 ? ratio / 0.02 * 0.2475 : std::sqrt(std::max(0.0, 1.0 - over * over));
  return (in ? 1.0 : -1.0) * area_m2 * up * kChoked / std::sqrt(source_K) * shape;
}

}  // namespace

Gas::Gas(const Rig& rig, double position, double gauge_bar, double leak_m2, double wall_time_s)
    : slope_(rig.pneumatic_slope),
      stiffness_(rig.pneumatic_stiffness),
      rest_(rig.rest_position),
      volume_at_rest_(rig.gas_volume_m3),
      wall_time_s_(rig.gas_wall_time_s + wall_time_s),
      area_m2_(rig.valve_flow_m2),
      leak_m2_(leak_m2),
      volume_m3_(Volume(position)),
      mass_kg_((gauge_bar + kAtmosphere_bar) * 1e5 * volume_m3_ / (kR * kWall_K)),
      temperature_K_(kWall_K),
      gauge_bar_(gauge_bar) {}

// Virtual work: dV/dq is the torque per pressure.
double Gas::Volume(double position) const {
  const double x = position - rest_;
  return std::max(0.1 * volume_at_rest_,
                  volume_at_rest_ + 1e-5 * (slope_ * x - 0.5 * stiffness_ * x * x));
}

double Gas::energy_J() const { return mass_kg_ * kCv * temperature_K_; }

void Gas::Step(double position, double regulator_bar, bool open, double step_s) noexcept {
  const double volume = Volume(position);
  const double pressure = (gauge_bar_ + kAtmosphere_bar) * 1e5;
  double flow = 0.0, source_K = kWall_K;
  if (open) {
    const double other = (regulator_bar + kAtmosphere_bar) * 1e5;
    source_K = other > pressure ? kWall_K : temperature_K_;
    flow = Flow(area_m2_, other, pressure, source_K);
  }
  // A leak takes the chamber's own gas; inwards it is too small to matter for the temperature.
  const double lost =
      leak_m2_ > 0.0 ? Flow(leak_m2_, kAtmosphere_bar * 1e5, pressure, temperature_K_) : 0.0;
  const double moved = std::max(flow * step_s, -0.5 * mass_kg_);
  const double heat = mass_kg_ * kCv * (kWall_K - temperature_K_) / wall_time_s_ * step_s;
  const double work = pressure * (volume - volume_m3_);
  const double energy =
      energy_J() + heat - work + moved * kCp * source_K + lost * step_s * kCp * temperature_K_;
  mass_kg_ += moved + lost * step_s;
  temperature_K_ = std::max(100.0, energy / (mass_kg_ * kCv));
  volume_m3_ = volume;
  gauge_bar_ = mass_kg_ * kR * temperature_K_ / volume * 1e-5 - kAtmosphere_bar;
}

}  // namespace sinew::rigs
