#include "sim/surrogate/gas.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace sinew::surrogate {
namespace {

constexpr double kLaminarRatio = 0.995;
constexpr double kSmallestMass_kg = 1e-12;

}  // namespace

Vessel::Vessel(double volume_m3, double pressure_Pa, double temperature_K,
               double wall_conductance_W_K)
    : volume_m3_(volume_m3), wall_conductance_W_K_(wall_conductance_W_K) {
  if (!(volume_m3 > 0.0) || !(pressure_Pa > 0.0) || !(temperature_K > 0.0) ||
      !(wall_conductance_W_K >= 0.0)) {
    throw std::invalid_argument(
        "vessel: volume, absolute pressure and temperature must be positive, "
        "wall conductance not negative");
  }
  Reset(volume_m3, pressure_Pa, temperature_K);
}

void Vessel::Reset(double volume_m3, double pressure_Pa, double temperature_K) noexcept {
  volume_m3_ = volume_m3;
  mass_kg_ = pressure_Pa * volume_m3 / (Air::kGasConstant_J_kgK * temperature_K);
  energy_J_ = mass_kg_ * Air::kCv_J_kgK * temperature_K;
  Update();
}

void Vessel::Update() noexcept {
  temperature_K_ = energy_J_ / (mass_kg_ * Air::kCv_J_kgK);
  pressure_Pa_ = energy_J_ * (Air::kGasConstant_J_kgK / Air::kCv_J_kgK) / volume_m3_;
}

void Vessel::SetVolume(double volume_m3) noexcept {
  constexpr double kExponent = Air::kGasConstant_J_kgK / Air::kCv_J_kgK;  // kappa - 1
  const double change = volume_m3_ / volume_m3 - 1.0;
  if (std::abs(change) < 1e-3) {
    // Binomial series of (1 + change)^kExponent; the error is below 1e-13.
    energy_J_ *= 1.0 + kExponent * change *
                           (1.0 + 0.5 * (kExponent - 1.0) * change *
                                      (1.0 + (kExponent - 2.0) / 3.0 * change *
                                                 (1.0 + (kExponent - 3.0) / 4.0 * change)));
  } else {
    energy_J_ *= std::pow(1.0 + change, kExponent);
  }
  volume_m3_ = volume_m3;
  Update();
}

void Vessel::AddMass(double mass_kg, double upstream_temperature_K) noexcept {
  if (mass_kg < 0.0) {
    mass_kg = std::max(mass_kg, -0.5 * mass_kg_);  // never empties in one step
    upstream_temperature_K = temperature_K_;
  }
  mass_kg_ = std::max(mass_kg_ + mass_kg, kSmallestMass_kg);
  energy_J_ += mass_kg * Air::kCp_J_kgK * upstream_temperature_K;
  energy_J_ = std::max(energy_J_, mass_kg_ * Air::kCv_J_kgK * 50.0);
  Update();
}

void Vessel::ExchangeHeat(double wall_temperature_K, double dt_s, double resistance_K_W) noexcept {
  // Exact for constant mass over the step: cannot overshoot the wall.
  const double conductance_W_K =
      wall_conductance_W_K_ / (1.0 + wall_conductance_W_K_ * resistance_K_W);
  const double rate_1_s = conductance_W_K / (mass_kg_ * Air::kCv_J_kgK);
  const double x = rate_1_s * dt_s;
  const double share = x < 1e-3 ? x * (1.0 - 0.5 * x) : -std::expm1(-x);
  energy_J_ += (wall_temperature_K - temperature_K_) * share * mass_kg_ * Air::kCv_J_kgK;
  Update();
}

double MassFlow_kg_s(const Orifice& orifice, double pressure_1_Pa, double temperature_1_K,
                     double pressure_2_Pa, double temperature_2_K) noexcept {
  double sign = 1.0;
  if (pressure_2_Pa > pressure_1_Pa) {
    std::swap(pressure_1_Pa, pressure_2_Pa);
    std::swap(temperature_1_K, temperature_2_K);
    sign = -1.0;
  }
  if (!(pressure_1_Pa > 0.0)) return 0.0;
  const double ratio = pressure_2_Pa / pressure_1_Pa;
  double psi = 1.0;
  const double b = orifice.critical_ratio;
  if (ratio >= kLaminarRatio) {
    const double edge = (kLaminarRatio - b) / (1.0 - b);
    psi = std::sqrt(1.0 - edge * edge) * (1.0 - ratio) / (1.0 - kLaminarRatio);
  } else if (ratio > b) {
    const double x = (ratio - b) / (1.0 - b);
    psi = std::sqrt(1.0 - x * x);
  }
  return sign * orifice.conductance_m3_sPa * Air::kReferenceDensity_kg_m3 * pressure_1_Pa *
         std::sqrt(Air::kReferenceTemperature_K / temperature_1_K) * psi;
}

Relay::Relay(const RelayParameters& parameters) : parameters_(parameters) {
  if (!(parameters.on_delay_s >= 0.0) || !(parameters.off_delay_s >= 0.0) ||
      !(parameters.travel_s >= 0.0)) {
    throw std::invalid_argument("relay: delays and travel must not be negative");
  }
}

void Relay::Reset(bool on) noexcept {
  on_ = on;
  waited_s_ = 0.0;
  opening_ = on ? 1.0 : 0.0;
}

double Relay::Step(bool command, double dt_s, double late_s) noexcept {
  if (command == on_) {
    waited_s_ = 0.0;
  } else {
    waited_s_ += dt_s;
    if (waited_s_ > (command ? parameters_.on_delay_s : parameters_.off_delay_s) + late_s) {
      on_ = command;
      waited_s_ = 0.0;
    }
  }
  const double target = on_ ? 1.0 : 0.0;
  if (parameters_.travel_s <= 0.0) {
    opening_ = target;
  } else {
    const double travel = dt_s / parameters_.travel_s;
    opening_ = std::clamp(target, opening_ - travel, opening_ + travel);
  }
  return opening_;
}

}  // namespace sinew::surrogate
