#include "sim/rigs/gas.h"

#include <algorithm>
#include <cmath>

namespace sinew::rigs {
namespace {
constexpr double kR = 287.05, kCv = 717.6, kCp = 1004.65;
constexpr double kWall_K = 293.15;
constexpr double kAtmosphere_bar = 1.01325;
constexpr double kChoked = 0.0404;  // sqrt(kg K / J), air
constexpr double kCriticalRatio = 0.35;
}  // namespace

Gas::Gas(const Rig& rig, double position, double gauge_bar)
    : slope_(rig.pneumatic_slope),
      stiffness_(rig.pneumatic_stiffness),
      rest_(rig.rest_position),
      volume_at_rest_(rig.gas_volume_m3),
      wall_time_s_(rig.gas_wall_time_s),
      area_m2_(rig.valve_flow_m2),
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
    const bool in = other > pressure;
    const double up = in ? other : pressure, down = in ? pressure : other;
    const double over = std::max(0.0, (down / up - kCriticalRatio) / (1.0 - kCriticalRatio));
    // Linear within the last 2 % of pressure, where the root would chatter.
    const double ratio = 1.0 - down / up;
    const double shape =
        ratio < 0.02 ? ratio / 0.02 * 0.2475 : std::sqrt(std::max(0.0, 1.0 - over * over));
    source_K = in ? kWall_K : temperature_K_;
    flow = (in ? 1.0 : -1.0) * area_m2_ * up * kChoked / std::sqrt(source_K) * shape;
  }
  const double moved = std::max(flow * step_s, -0.5 * mass_kg_);
  const double heat = mass_kg_ * kCv * (kWall_K - temperature_K_) / wall_time_s_ * step_s;
  const double work = pressure * (volume - volume_m3_);
  const double energy = energy_J() + heat - work + moved * kCp * source_K;
  mass_kg_ += moved;
  temperature_K_ = std::max(100.0, energy / (mass_kg_ * kCv));
  volume_m3_ = volume;
  gauge_bar_ = mass_kg_ * kR * temperature_K_ / volume * 1e-5 - kAtmosphere_bar;
}

}  // namespace sinew::rigs
