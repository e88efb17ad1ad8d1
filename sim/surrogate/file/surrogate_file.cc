#include "sim/surrogate/file/surrogate_file.h"

#include <sstream>
#include <stdexcept>

#include "sim/surrogate/rig.h"

namespace sinew::surrogate {
using config::kNotNegative;
using config::kPositive;

static void Describe(config::Fields& f, SlipParameters& c) {
  f("coulomb_Nm", c.kinetic_Nm, kNotNegative, "sliding");
  f("rest_growth_Nm", c.rest_growth_Nm, kNotNegative, "more after rest");
  f("rest_time_s", c.rest_time_s, kPositive, "of its growth");
  f("renewal_distance_rad", c.renewal_distance_rad, kPositive, "slip that wears it off");
  f("presliding_rad", c.presliding_rad, kPositive, "elastic before it slips");
  f("presliding_damping_s", c.presliding_damping_s, kNotNegative, "of the elastic part");
}

static void Describe(config::Fields& f, RelayParameters& c) {
  f("on_delay_s", c.on_delay_s, kNotNegative, "dead time");
  f("off_delay_s", c.off_delay_s, kNotNegative, "dead time");
  f("travel_s", c.travel_s, kNotNegative, "of what it moves");
}

static void Describe(config::Fields& f, Orifice& c) {
  f("conductance_m3_sPa", c.conductance_m3_sPa, kNotNegative, "ISO 6358");
  f("critical_ratio_1", c.critical_ratio, {0.0, 0.9}, "choked below it");
}

static void Describe(config::Fields& f, DriveParameters& c) {
  f("rate_Hz", c.rate_Hz, {500.0, 24000.0}, "of its loops");
  f("position_gain_1_s", c.position_gain_1_s, kNotNegative, "speed per error");
  f("velocity_gain_Nm_s_rad", c.velocity_gain_Nm_s_rad, kNotNegative, "torque per speed error");
  f("velocity_integral_gain_Nm_rad", c.velocity_integral_gain_Nm_rad, kNotNegative, "its integral");
  f("velocity_limit_rad_s", c.velocity_limit_rad_s, kPositive, "of the motor");
  f("torque_limit_Nm", c.torque_limit_Nm, kPositive, "at the shaft");
  f("estimator_bandwidth_rad_s", c.estimator_bandwidth_rad_s, kPositive,
    "of the phase-locked loop");
}

static void DescribeMotor(config::Fields& f, RigParameters* rig) {
  MotorParameters& c = rig->motor;
  f("torque_constant_Nm_A", c.torque_constant_Nm_A, kPositive, "at the shaft");
  f("pole_pairs", c.pole_pairs, {1.0, 100.0}, "of the magnets");
  f("resistance_ohm", c.resistance_ohm, kPositive, "of a phase");
  f("inductance_H", c.inductance_H, kPositive, "of a phase");
  f("bus_voltage_V", c.bus_voltage_V, kPositive, "limits the current at speed");
  f("current_limit_A", c.current_limit_A, kPositive, "of the drive");
  f("current_bandwidth_rad_s", c.current_bandwidth_rad_s, {1.0, 10000.0}, "of the current loop");
  f("three_phase", c.three_phase, "integrates the phases");
  f("emf_flatness_1", c.emf_flatness, {0.0, 1.0}, "0: sine, 1: trapezium");
  f("ambient_degC", c.ambient_degC, "around the motor");
  f("initial_rise_K", c.initial_rise_K, {0.0, 150.0}, "of the winding at the start");
  f("heat_capacity_J_K", c.heat_capacity_J_K, kPositive, "of the winding");
  f("thermal_resistance_K_W", c.thermal_resistance_K_W, kPositive, "winding to ambient");
  RotorParameters& rotor = rig->rotor;
  f("rotor_inertia_kg_m2", rotor.inertia_kg_m2, kPositive, "with the first gear stage");
  f("viscous_Nm_s_rad", rotor.viscous_Nm_s_rad, kNotNegative, "at the rotor");
  f("dry_friction", rotor.friction, "at the rotor");
  f("drive", rig->drive, "loops of speed and position");
}

static void Describe(config::Fields& f, GearParameters& c) {
  f("ratio_1", c.ratio, kPositive, "motor turns per output turn");
  f("play_rad", c.play_rad, {0.0, 1e6}, "at the output, full width; huge: uncoupled");
  f("contact_stiffness_Nm_rad", c.contact_stiffness_Nm_rad, kPositive, "teeth, at the output");
  f("contact_damping_Nm_s_rad", c.contact_damping_Nm_s_rad, kNotNegative, "of the teeth");
  f("damping_depth_rad", c.damping_depth_rad, kPositive, "over which damping grows");
  f("torque_share_drive_1", c.share_drive, {0.01, 1.0}, "of the air-gap torque, driving");
  f("torque_share_back_1", c.share_back, {0.01, 2.0}, "the same, driven back");
  f("load_friction_1", c.load_friction, kNotNegative, "rotor friction per tooth torque / ratio");
}

static void Describe(config::Fields& f, LinkParameters& c) {
  f("inertia_kg_m2", c.inertia_kg_m2, kPositive, "about the joint");
  f("gravity_torque_Nm", c.gravity_torque_Nm, "at 0 rad (horizontal)");
  f("length_m", c.length_m, kPositive, "to load cell and payload");
  f("gravity_m_s2", c.gravity_m_s2, kNotNegative, "of the payload");
  f("viscous_Nm_s_rad", c.viscous_Nm_s_rad, kNotNegative, "of the output");
  f("declared_payload_kg", c.declared_payload_kg, {0.0, 20.0}, "at the load cell");
  f("end_stop_rad", c.end_stop_rad, {0.1, 100.0}, "to both sides");
  f("dry_friction", c.friction, "bearings, seal, gear");
}

static void Describe(config::Fields& f, PneumaticParameters& c) {
  f("displacement_m3_rad", c.displacement_m3_rad, kNotNegative, "dV/dq");
  f("displacement_shape_1", c.displacement_shape, "share of it at equal steps over the travel");
  f("dead_volume_m3", c.dead_volume_m3, kPositive, "chamber at its lower stop");
  f("chamber_wall_W_K", c.chamber_wall_W_K, kNotNegative, "heat exchange");
  f("reservoir_volume_m3", c.reservoir_volume_m3, kPositive, "of the tank");
  f("reservoir_wall_W_K", c.reservoir_wall_W_K, kNotNegative, "heat exchange");
  f("atmosphere_Pa", c.atmosphere_Pa, {5e4, 1.2e5}, "absolute");
  f("wall_temperature_K", c.wall_temperature_K, {200.0, 400.0}, "of both");
  f("compressor_kg_s", c.compressor_kg_s, kNotNegative, "at 0 bar");
  f("compressor_limit_bar", c.compressor_limit_bar, kPositive, "delivers nothing at it");
  f("initial_pressure_bar", c.initial_pressure_bar, {0.0, 10.0}, "chamber and reservoir, gauge");
  f("initial_valve_open", c.initial_valve_open, "until the first command");
  f("valve", c.valve, "between them");
  f("vent", c.vent, "of the reservoir");
  f("seal_leak", c.seal_leak, "of the chamber");
  f("valve_relay", c.valve_relay, "switches the valve");
  f("compressor_relay", c.compressor_relay, "switches the compressor");
  f("vent_relay", c.vent_relay, "switches the vent");
}

static void Describe(config::Fields& f, SensorParameters& c) {
  f("encoder_counts", c.encoder_counts, {16.0, 1e9}, "per turn, both encoders");
  f("motor_encoder_noise_rad", c.motor_encoder_noise_rad, kNotNegative, "standard deviation");
  f("output_encoder_noise_rad", c.output_encoder_noise_rad, kNotNegative, "standard deviation");
  f("output_observer_rad_s", c.output_observer_rad_s, kPositive, "bandwidth of its velocity");
  f("current_noise_A", c.current_noise_A, kNotNegative, "standard deviation");
  f("load_cell_noise_N", c.load_cell_noise_N, kNotNegative, "standard deviation");
  f("pressure_noise_bar", c.pressure_noise_bar, kNotNegative, "standard deviation");
  f("pressure_counts", c.pressure_counts, {2.0, 1e9}, "of the range");
  f("pressure_range_bar", c.pressure_range_bar, kPositive, "from 0");
  f("temperature_noise_degC", c.temperature_noise_degC, kNotNegative, "standard deviation");
  f("temperature_step_degC", c.temperature_step_degC, kNotNegative, "of the reading");
  f("latch_phase_1", c.latch_phase, {0.0, 1.0}, "when in a cycle readings are latched");
  f("torque_efficiency_1", c.torque_efficiency, kPositive, "of the torque computed from current");
}

void Describe(config::Fields& f, RigParameters& c) {
  std::vector<std::string> effects;
  f.Object("motor", "with rotor and drive", [&](config::Fields& g) { DescribeMotor(g, &c); });
  f("gear", c.gear, "with its play");
  f("link", c.link, "with the payload");
  f("pneumatics", c.pneumatics, "chamber and air supply");
  f("sensors", c.sensors, "noise and resolution");
  f("step_s", c.step_s, {1e-6, 1e-4}, "longest internal step");
  f("initial_angle_rad", c.initial_angle_rad, "of the output");
  f("initial_rest_s", c.initial_rest_s, kNotNegative, "how long it has stood there");
  f("rotor_locked", c.rotor_locked, "mechanically");
  f("spread_1", c.spread, {0.0, 0.3}, "parameters differ by up to this share, from the seed");
  f("effects", effects, "undeclared ones, NAME or NAME=SIZE (sinew-surrogate --list-effects)");
  f.Others({"guard"});
  f.Check("effects", [&] {
    for (const std::string& text : effects) {
      if (const auto effect = ParseEffect(text)) c.effects.push_back(*effect);
    }
  });
  if (!f.reads()) return;
  try {
    const Rig check(c);
  } catch (const std::invalid_argument& error) {
    throw UsageError(f.section().file().string() + ": " + error.what());
  }
}

RigParameters ReadRig(const config::Section& section) {
  return config::Read<RigParameters>(section);
}

config::Section OpenSurrogate(const std::filesystem::path& path) {
  return path.empty() ? config::Section::Empty("defaults") : config::Section::Load(path, kSchema);
}

RigParameters LoadRig(const std::filesystem::path& path) { return ReadRig(OpenSurrogate(path)); }

std::string DescribeEffects() {
  std::ostringstream text;
  text << "none\n";
  for (const EffectInfo& effect : UndeclaredEffects()) {
    text << effect.name << " (default " << effect.default_size << ' ' << effect.unit
         << "): " << effect.mechanism << '\n';
  }
  return text.str();
}

std::vector<EffectSpec> ParseEffects(const std::vector<std::string>& texts) {
  std::vector<EffectSpec> effects;
  for (const std::string& text : texts) {
    try {
      if (const auto effect = ParseEffect(text)) effects.push_back(*effect);
    } catch (const std::invalid_argument& error) {
      throw UsageError(std::string("--effect: ") + error.what());
    }
  }
  return effects;
}

}  // namespace sinew::surrogate
