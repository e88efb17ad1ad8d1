#include "bench/rigs/drawn/forces.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bench/rigs/drawn/random.h"
#include "components/base/types/angle.h"

namespace sinew::rigs {
namespace {
using types::kPi;
constexpr double kImpact_s = 0.008;

constexpr std::pair<const char*, double Undeclared::*> kSizes[] = {
    {"direction_dependent_coulomb", &Undeclared::coulomb_asymmetry},
    {"direction_dependent_viscous", &Undeclared::viscous_asymmetry},
    {"quadratic_viscous", &Undeclared::quadratic},
    {"stribeck", &Undeclared::stribeck},
    {"presliding", &Undeclared::presliding},
    {"load_dependent_friction", &Undeclared::load_share},
    {"drive_efficiency_direction", &Undeclared::backward_gain},
    {"temperature_friction", &Undeclared::warm_share},
    {"cogging", &Undeclared::cogging},
    {"gear_eccentricity", &Undeclared::eccentricity},
    {"gear_compliance", &Undeclared::tooth_compliance},
    {"backlash_width", &Undeclared::play},
    {"encoder_eccentricity", &Undeclared::encoder_wave},
    {"elastic_joint", &Undeclared::elastic_s},
    {"flexible_link", &Undeclared::flexible_share},
    {"transport_delay", &Undeclared::delay_s},
    {"torque_constant_saturation", &Undeclared::saturation},
    {"torque_constant_gain", &Undeclared::drive_gain},
    {"current_offset", &Undeclared::current_offset},
    {"payload", &Undeclared::payload_kg},
    {"payload_step", &Undeclared::step_kg},
    {"external_bump", &Undeclared::bump},
    {"load_cell_gain", &Undeclared::cell_gain},
    {"load_cell_misalignment", &Undeclared::cell_angle},
    {"gravity_phase", &Undeclared::tilt},
    {"pressure_dependent_friction", &Undeclared::pressure_friction},
    {"pressure_gain", &Undeclared::pressure_gain},
    {"pressure_offset", &Undeclared::pressure_offset},
    {"pressure_lag", &Undeclared::pressure_lag_s},
    {"seal_hysteresis", &Undeclared::seal},
    {"stiffness_collapse", &Undeclared::collapse},
    {"leak", &Undeclared::leak_m2},
    {"gas_heat_exchange", &Undeclared::gas_wall_s},
    {"cable_drag", &Undeclared::cable},
    {"bad_tooth", &Undeclared::tooth_defect},
    {"supply_sag", &Undeclared::sag},
    {"slow_tilt", &Undeclared::slow_tilt},
    {"slipping_magnet", &Undeclared::slip},
    {"stiction_after_rest", &Undeclared::rest_stiction},
    {"impacts", &Undeclared::impacts},
    {"warm_up", &Undeclared::warm_up},
};
constexpr std::pair<const char*, std::array<double, 4> Undeclared::*> kShapes[] = {
    {"cogging", &Undeclared::cogging_shape},
    {"gear_eccentricity", &Undeclared::eccentricity_shape},
    {"encoder_eccentricity", &Undeclared::encoder_shape},
    {"flexible_link", &Undeclared::flexible_shape},
    {"seal_hysteresis", &Undeclared::seal_shape},
    {"stiffness_collapse", &Undeclared::collapse_shape},
    {"cable_drag", &Undeclared::cable_shape},
    {"bad_tooth", &Undeclared::defect_shape},
    {"stiction_after_rest", &Undeclared::rest_shape},
    {"warm_up", &Undeclared::warm_shape},
};
}  // namespace

Undeclared Resolve(const Rig& rig, const std::vector<Effect>& effects, const Motion& motion) {
  Undeclared u;
  for (const Effect& effect : effects) {
    FindEffect(effect.name);  // throws
    for (const auto& [name, member] : kSizes) {
      if (effect.name == name) u.*member = effect.size;
    }
    for (const auto& [name, member] : kShapes) {
      if (effect.name == name) u.*member = effect.shape;
    }
    if (effect.name == "stribeck") u.stribeck_speed = effect.shape[0];
  }
  Random random(rig.number, 2000 + motion.recording());
  const double T = motion.duration_s();
  u.step_start_s = T * random.Uniform(0.25, 0.75);
  u.bump_start_s = T * random.Uniform(0.1, 0.9);
  u.bump_length_s = random.Uniform(0.15, 0.5) / rig.frequency_Hz;
  for (double& slip : u.slips_s) slip = T * random.Uniform(0.1, 0.95);
  if (u.impacts != 0.0) {
    const int count = random.Integer(8, 20);
    for (int i = 0; i < count; ++i) {
      u.hits.push_back({T * random.Uniform(0.03, 0.97), random.Sign() * random.Uniform(0.4, 1.0)});
    }
  }
  return u;
}

double StepBristle(double zeta, double velocity, double length, double step_s,
                   bool stiction) noexcept {
  const double sign = velocity >= 0.0 ? 1.0 : -1.0;
  const double r = std::abs(velocity) * step_s / length;
  double alpha = 1.0;
  if (stiction) {
    const double along = zeta * sign;
    constexpr double kElastic = 0.7;
    if (along < kElastic) {
      alpha = 0.0;
    } else if (along < 1.0) {
      alpha = 0.5 - 0.5 * std::cos(kPi * (along - kElastic) / (1.0 - kElastic));
    }
  }
  // Implicit: for any step the state stays within its range.
  return std::clamp((zeta + sign * r) / (1.0 + alpha * r), -1.0, 1.0);
}

double PositionForce(const Undeclared& u, double position, double amplitude) noexcept {
  double force = 0.0;
  if (u.eccentricity != 0.0) {
    const auto& s = u.eccentricity_shape;
    const double angle = s[0] * position + s[1];
    force += u.eccentricity * (std::sin(angle) + 0.1 * std::sin(2.0 * angle));
  }
  if (u.cable != 0.0) {
    // A cable that comes taut: softplus of the way past its angle.
    const double width = 0.03 * amplitude;
    const double past = (position - u.cable_shape[0]) / width;
    force -=
        u.cable * width / (0.4 * amplitude) * (past > 30.0 ? past : std::log1p(std::exp(past)));
  }
  if (u.tooth_defect != 0.0) {
    const double s = (position - u.defect_shape[0]) / u.defect_shape[1];
    if (std::abs(s) < 3.0) force -= u.tooth_defect * std::exp(-s * s * s * s);
  }
  return force;
}

double EventForce(const Undeclared& u, double time_s) noexcept {
  double force = 0.0;
  if (u.bump != 0.0) {
    const double s = (time_s - u.bump_start_s) / u.bump_length_s;
    if (s > 0.0 && s < 1.0) force += u.bump * std::pow(4.0 * s * (1.0 - s), 1.5);
  }
  for (const auto& [start, share] : u.hits) {
    const double s = (time_s - start) / kImpact_s;
    if (s > 0.0 && s < 1.0) force += u.impacts * share * std::sin(kPi * s);
  }
  return force;
}

double MotorForce(const Undeclared& u, double motor_angle) noexcept {
  const auto& s = u.cogging_shape;
  const double angle = s[0] * motor_angle + s[1];
  return u.cogging * (std::sin(angle) + s[2] * std::sin(2.0 * angle));
}

double Saturated(const Undeclared& u, double current, double limit) noexcept {
  if (u.saturation <= 0.0) return current;
  const double keep = 1.0 - std::min(0.95, u.saturation);
  const double a = (1.0 / (keep * keep) - 1.0) / (limit * limit);
  return current / std::sqrt(1.0 + a * current * current);
}

}  // namespace sinew::rigs
