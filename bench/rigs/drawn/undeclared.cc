#include "bench/rigs/drawn/undeclared.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "bench/rigs/drawn/random.h"
#include "components/base/types/angle.h"

namespace sinew::rigs {
namespace {

using types::kPi;

std::vector<EffectInfo> MakeAll() {
  using enum Kind;
  using enum Shows;
  return {
      {"direction_dependent_coulomb", kCatalogue, kTorque, "force", "velocity_rad_s"},
      {"direction_dependent_viscous", kCatalogue, kTorque, "force/speed", "velocity_rad_s"},
      {"quadratic_viscous", kCatalogue, kTorque, "force at typical speed", "motor_velocity_rad_s"},
      {"stribeck", kCatalogue, kTorque, "force", "velocity_rad_s"},
      {"presliding", kCatalogue, kTorque, "displacement", "position_rad"},
      {"load_dependent_friction", kCatalogue, kTorque, "share", "drive_input"},
      {"drive_efficiency_direction", kCatalogue, kTorque, "share", "drive_input"},
      {"temperature_friction", kCatalogue, kTorque, "share per K", "temperature_degC"},
      {"cogging", kCatalogue, kTorque, "force", "motor_position_rad"},
      {"gear_eccentricity", kCatalogue, kTorque, "force", "position_rad"},
      {"gear_compliance", kCatalogue, kKinematic, "rad/Nm", "drive_input"},
      {"backlash_width", kCatalogue, kKinematic, "rad", "drive_input"},
      {"encoder_eccentricity", kCatalogue, kKinematic, "rad", "position_rad"},
      {"elastic_joint", kCatalogue, kTorque, "s", "jerk"},
      {"flexible_link", kCatalogue, kTorque, "share of inertia", "acceleration_rad_s2"},
      {"transport_delay", kCatalogue, kTorque, "s", "drive_rate"},
      {"torque_constant_saturation", kCatalogue, kTorque, "share at the current limit",
       "drive_input"},
      {"torque_constant_gain", kCatalogue, kTorque, "share", "drive_input", true},
      {"current_offset", kCatalogue, kTorque, "A", "none"},
      {"payload", kCatalogue, kTorque, "kg", "position_rad", true},
      {"payload_step", kCatalogue, kTorque, "kg", "time_s"},
      {"external_bump", kCatalogue, kTorque, "force", "time_s"},
      {"load_cell_gain", kCatalogue, kTorque, "share", "load_force_N"},
      {"load_cell_misalignment", kCatalogue, kTorque, "rad", "load_force_N"},
      {"gravity_phase", kCatalogue, kTorque, "rad", "position_rad"},
      {"pressure_dependent_friction", kCatalogue, kTorque, "force/bar", "pressure_bar"},
      {"pressure_gain", kCatalogue, kTorque, "share", "pressure_bar", true},
      {"pressure_offset", kCatalogue, kTorque, "bar", "position_rad"},
      {"pressure_lag", kCatalogue, kTorque, "s", "pressure_bar"},
      {"seal_hysteresis", kCatalogue, kTorque, "force/bar", "position_rad"},
      {"stiffness_collapse", kCatalogue, kTorque, "share", "pressure_bar"},
      {"leak", kCatalogue, kGas, "m2", "pressure_bar"},
      {"gas_heat_exchange", kCatalogue, kGas, "s", "pressure_bar"},
      {"cable_drag", kOutside, kTorque, "force", "position_rad"},
      {"bad_tooth", kOutside, kTorque, "force", "position_rad"},
      {"supply_sag", kOutside, kTorque, "share", "drive_input"},
      {"slow_tilt", kOutside, kTorque, "rad", "time_s"},
      {"slipping_magnet", kOutside, kTorque, "rad", "time_s"},
      {"stiction_after_rest", kIgnorance, kTorque, "force", ""},
      {"impacts", kIgnorance, kTorque, "force", ""},
      {"warm_up", kIgnorance, kTorque, "share", "time_s"},
  };
}

bool Measures(Drive drive) { return drive == Drive::kSensor; }

bool CanHave(const Rig& rig, const std::string& name) {
  const bool gear = rig.coupling != Coupling::kRigid;
  const bool gravity = rig.gravity_torque > 0.0;
  const bool drive = !Measures(rig.drive);  // a torque sensor sees nothing of the motor's side
  const bool amplifier = rig.drive == Drive::kCurrent || rig.drive == Drive::kCommand;
  struct Rule {
    const char* name;
    bool can;
  };
  const Rule rules[] = {
      {"quadratic_viscous", drive},
      {"load_dependent_friction", drive && (gear || rig.family == Family::kServo)},
      {"drive_efficiency_direction", drive && gear},
      {"temperature_friction", rig.temperature},
      {"cogging", drive && rig.motor_encoder},
      {"gear_eccentricity", !rig.linear && gear},
      {"gear_compliance", rig.kinematic},
      {"backlash_width", rig.kinematic && rig.play > 0.0},
      {"encoder_eccentricity", rig.kinematic},
      {"elastic_joint", !gear && !Measures(rig.drive)},
      {"flexible_link", !rig.linear},
      {"transport_delay", drive},
      {"torque_constant_saturation", amplifier},
      {"torque_constant_gain", amplifier},
      {"current_offset", rig.drive == Drive::kCurrent && gravity},
      {"payload", gravity},
      {"payload_step", gravity},
      {"load_cell_gain", rig.load_cell},
      {"load_cell_misalignment", rig.load_cell},
      {"gravity_phase", gravity},
      {"pressure_dependent_friction", rig.pressure},
      {"pressure_gain", rig.pressure},
      {"pressure_offset", rig.pressure && rig.pneumatic_stiffness > 0.0},
      {"pressure_lag", rig.pressure},
      {"seal_hysteresis", rig.pressure},
      {"stiffness_collapse", rig.pneumatic_stiffness > 0.0},
      {"leak", rig.gas_balance},
      {"gas_heat_exchange", rig.gas_balance},
      {"supply_sag", amplifier},
      {"slow_tilt", gravity},
      {"slipping_magnet", gravity && rig.output_encoder},
  };
  for (const Rule& rule : rules) {
    if (name == rule.name) return rule.can;
  }
  return true;
}

}  // namespace

const std::vector<EffectInfo>& AllEffects() {
  static const std::vector<EffectInfo> kAll = MakeAll();
  return kAll;
}

const EffectInfo& FindEffect(const std::string& name) {
  for (const EffectInfo& info : AllEffects()) {
    if (info.name == name) return info;
  }
  throw std::invalid_argument("no effect is called " + name);
}

std::vector<std::string> EffectsOf(const Rig& rig, Kind kind) {
  std::vector<std::string> names;
  for (const EffectInfo& info : AllEffects()) {
    if (info.kind == kind && CanHave(rig, info.name)) names.push_back(info.name);
  }
  return names;
}

double LargestSize(const Rig& rig, const std::string& name) {
  const double force = rig.force_scale();
  const double viscous = rig.link_viscous + (Measures(rig.drive) ? 0.0 : rig.motor_viscous);
  const double cap_K = rig.play > 0.0 ? 0.2 * rig.play : 0.01;
  struct Limit {
    const char* name;
    double size;
  };
  const Limit limits[] = {
      {"direction_dependent_coulomb", 0.8 * rig.coulomb},
      {"direction_dependent_viscous", 0.9 * viscous},  // never against the motion
      {"stribeck", std::max(2.0 * rig.coulomb, 0.3 * force)},
      {"presliding", 0.3 * rig.amplitude},
      {"load_dependent_friction", 0.3},
      {"drive_efficiency_direction", 0.4},
      {"temperature_friction", 0.06},
      {"gear_compliance", cap_K / force},
      {"backlash_width", cap_K},
      {"encoder_eccentricity", cap_K},
      {"elastic_joint", 0.03},
      {"flexible_link", 0.3},
      {"transport_delay", 0.05},
      {"torque_constant_saturation", 0.5},
      {"torque_constant_gain", 0.5},
      {"current_offset", 0.1 * rig.current_limit_A},
      {"payload", rig.gravity_torque / (9.81 * rig.link_length_m)},
      {"payload_step", rig.gravity_torque / (9.81 * rig.link_length_m)},
      {"external_bump", 2.0 * force},
      {"load_cell_gain", 0.5},
      {"load_cell_misalignment", 0.8},
      {"gravity_phase", 0.4},
      {"pressure_dependent_friction", force / rig.pressure_max_bar},
      {"pressure_gain", 0.5},
      {"pressure_offset", 0.3 * rig.pressure_max_bar},
      {"pressure_lag", 0.5},
      {"seal_hysteresis", force / rig.pressure_max_bar},
      {"stiffness_collapse", 1.0},
      {"leak", 0.05 * rig.valve_flow_m2},
      {"gas_heat_exchange", 3.0},
      {"supply_sag", 0.5},
      {"slow_tilt", 0.4},
      {"slipping_magnet", 0.4},
      {"warm_up", 4.0},
      {"impacts", 5.0 * force},
  };
  for (const Limit& limit : limits) {
    if (name == limit.name) return limit.size;
  }
  return force;
}

Effect DrawEffect(const Rig& rig, const std::string& name) {
  const auto& all = AllEffects();
  const auto at = static_cast<std::uint64_t>(&FindEffect(name) - all.data());
  Random random(rig.number, 100 + at);
  Effect out{name, 0.01 * LargestSize(rig, name), {}};
  for (double& x : out.shape) x = random.Uniform();
  auto& shape = out.shape;
  if (name == "stribeck") shape[0] = rig.speed() * random.LogUniform(0.04, 0.2);
  if (name == "cogging") {
    // Slots that go with 2 p poles: the least common multiple, the electrical orders beside it.
    const int p = rig.pole_pairs;
    const int orders[] = {p, 2 * p, 6 * p, 12 * p};
    shape[0] = orders[random.Integer(0, 3)];
    shape[1] = 2.0 * kPi * random.Uniform();
    shape[2] = random.Uniform(0.0, 0.15);  // of its second harmonic
  }
  if (name == "gear_eccentricity" || name == "encoder_eccentricity") {
    shape[0] = random.Integer(1, 3) + (name == "encoder_eccentricity" ? 0 : 1);
    shape[1] = 2.0 * kPi * random.Uniform();
    if (name == "encoder_eccentricity") shape[0] = random.Integer(1, 2);
  }
  if (name == "flexible_link") {
    shape[0] = std::min(0.2 * rig.rate_Hz, random.LogUniform(4.0, 12.0) * rig.frequency_Hz);  // Hz
    shape[1] = random.Uniform(0.01, 0.05);  // zeta
  }
  if (name == "seal_hysteresis") shape[0] = rig.amplitude * random.LogUniform(0.03, 0.15);
  if (name == "stiffness_collapse") shape[0] = rig.pressure_max_bar * random.Uniform(0.1, 0.25);
  if (name == "cable_drag") shape[0] = rig.centre + rig.amplitude * random.Uniform(0.2, 0.5);
  if (name == "bad_tooth") {
    shape[0] = rig.centre + rig.amplitude * random.Uniform(-0.5, 0.5);
    shape[1] = rig.amplitude * random.LogUniform(0.01, 0.05);
  }
  if (name == "stiction_after_rest") shape[0] = random.LogUniform(0.05, 0.5);
  if (name == "warm_up") shape[0] = random.Uniform(0.2, 0.6);  // of a recording
  // Signs of what may have either.
  for (const char* either :
       {"direction_dependent_coulomb", "direction_dependent_viscous", "drive_efficiency_direction",
        "torque_constant_gain", "current_offset", "external_bump", "load_cell_gain",
        "gravity_phase", "pressure_gain", "pressure_offset", "slow_tilt", "slipping_magnet",
        "load_cell_misalignment"}) {
    if (name == either) out.size *= random.Sign();
  }
  if (name == "drive_efficiency_direction") out.size = -std::abs(out.size);
  return out;
}

}  // namespace sinew::rigs
