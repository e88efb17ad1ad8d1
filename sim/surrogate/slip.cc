#include "sim/surrogate/slip.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace sinew::surrogate {
namespace {

// Share of the yield torque and yield displacement (relative to the mean) of each element.
constexpr std::array<double, SlipBank::kElements> kWeight{0.15, 0.25, 0.25, 0.2, 0.15};
constexpr std::array<double, SlipBank::kElements> kYieldDisplacement{0.5, 0.75, 1.0, 1.25, 1.6};

double Require(double value, bool positive, const char* name) {
  if (!std::isfinite(value) || value < 0.0 || (positive && value == 0.0)) {
    throw std::invalid_argument(std::string(name) + " is " + std::to_string(value) + ", expected " +
                                (positive ? "> 0" : ">= 0"));
  }
  return value;
}

}  // namespace

SlipBank::SlipBank(const SlipParameters& parameters) : parameters_(parameters) {
  Require(parameters.kinetic_Nm, false, "kinetic_Nm");
  Require(parameters.rest_growth_Nm, false, "rest_growth_Nm");
  Require(parameters.rest_time_s, true, "rest_time_s");
  Require(parameters.renewal_distance_rad, true, "renewal_distance_rad");
  Require(parameters.presliding_rad, true, "presliding_rad");
  Require(parameters.presliding_damping_s, false, "presliding_damping_s");
  for (int i = 0; i < kElements; ++i) {
    weight_[i] = kWeight[i];
    stiffness_Nm_rad_[i] =
        kWeight[i] * parameters.kinetic_Nm / (kYieldDisplacement[i] * parameters.presliding_rad);
    stiffness_total_Nm_rad_ += stiffness_Nm_rad_[i];
  }
  Reset(0.0);
}

void SlipBank::Reset(double rest_s) noexcept {
  deflection_rad_.fill(0.0);
  age_s_ = std::max(0.0, rest_s);
  yield_Nm_ = parameters_.kinetic_Nm;
}

double SlipBank::Step(double velocity_rad_s, double dt_s, double strength_scale) noexcept {
  if (stiffness_total_Nm_rad_ <= 0.0) return 0.0;
  double growth = 0.0;
  const double relative_age = age_s_ / parameters_.rest_time_s;
  if (relative_age > 0.0) {
    const double power = relative_age * std::sqrt(relative_age);
    growth = power < 1e-4 ? power : -std::expm1(-power);
  }
  yield_Nm_ = parameters_.kinetic_Nm * strength_scale + parameters_.rest_growth_Nm * growth;

  double torque_Nm = 0.0;
  double held_rate_rad_s = 0.0;
  for (int i = 0; i < kElements; ++i) {
    const double limit_rad = weight_[i] * yield_Nm_ / stiffness_Nm_rad_[i];
    const double before_rad = deflection_rad_[i];
    const double after_rad = std::clamp(before_rad + velocity_rad_s * dt_s, -limit_rad, limit_rad);
    deflection_rad_[i] = after_rad;
    // A weakening contact lets its spring shorten: that is slip, not motion of the spring's damper.
    double rate_rad_s = (after_rad - before_rad) / dt_s;
    if (rate_rad_s * velocity_rad_s < 0.0) rate_rad_s = 0.0;
    held_rate_rad_s += weight_[i] * rate_rad_s;
    torque_Nm += stiffness_Nm_rad_[i] * (after_rad + parameters_.presliding_damping_s * rate_rad_s);
  }
  const double slip_rad = std::abs(velocity_rad_s - held_rate_rad_s) * dt_s;
  age_s_ = (age_s_ + dt_s) / (1.0 + slip_rad / parameters_.renewal_distance_rad);
  return -torque_Nm;
}

double SlipBank::spring_energy_J() const noexcept {
  double energy_J = 0.0;
  for (int i = 0; i < kElements; ++i) {
    energy_J += 0.5 * stiffness_Nm_rad_[i] * deflection_rad_[i] * deflection_rad_[i];
  }
  return energy_J;
}

}  // namespace sinew::surrogate
