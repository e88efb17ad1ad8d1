#include "sim/surrogate/file/surrogate_file.h"

#include <sstream>
#include <stdexcept>

#include "sim/surrogate/rig.h"

namespace sinew::surrogate {
namespace {

using config::kNotNegative;
using config::kPositive;
using config::Section;

constexpr std::string_view kSchema = "sinew-surrogate/1";

void ReadSlip(const Section& s, SlipParameters* p) {
  p->kinetic_Nm = s.NumberOr("coulomb_Nm", p->kinetic_Nm, kNotNegative);
  p->rest_growth_Nm = s.NumberOr("rest_growth_Nm", p->rest_growth_Nm, kNotNegative);
  p->rest_time_s = s.NumberOr("rest_time_s", p->rest_time_s, kPositive);
  p->renewal_distance_rad = s.NumberOr("renewal_distance_rad", p->renewal_distance_rad, kPositive);
  p->presliding_rad = s.NumberOr("presliding_rad", p->presliding_rad, kPositive);
  p->presliding_damping_s =
      s.NumberOr("presliding_damping_s", p->presliding_damping_s, kNotNegative);
  s.RejectUnknownKeys();
}

void ReadRelay(const Section& s, RelayParameters* p) {
  p->on_delay_s = s.NumberOr("on_delay_s", p->on_delay_s, kNotNegative);
  p->off_delay_s = s.NumberOr("off_delay_s", p->off_delay_s, kNotNegative);
  p->travel_s = s.NumberOr("travel_s", p->travel_s, kNotNegative);
  s.RejectUnknownKeys();
}

void ReadOrifice(const Section& s, Orifice* p) {
  p->conductance_m3_sPa = s.NumberOr("conductance_m3_sPa", p->conductance_m3_sPa, kNotNegative);
  p->critical_ratio = s.NumberOr("critical_ratio_1", p->critical_ratio, {0.0, 0.9});
  s.RejectUnknownKeys();
}

void ReadMotor(const Section& s, MotorParameters* p, DriveParameters* drive,
               RotorParameters* rotor) {
  p->torque_constant_Nm_A = s.NumberOr("torque_constant_Nm_A", p->torque_constant_Nm_A, kPositive);
  p->pole_pairs = static_cast<int>(s.IntegerOr("pole_pairs", p->pole_pairs, {1.0, 100.0}));
  p->resistance_ohm = s.NumberOr("resistance_ohm", p->resistance_ohm, kPositive);
  p->inductance_H = s.NumberOr("inductance_H", p->inductance_H, kPositive);
  p->bus_voltage_V = s.NumberOr("bus_voltage_V", p->bus_voltage_V, kPositive);
  p->current_limit_A = s.NumberOr("current_limit_A", p->current_limit_A, kPositive);
  p->current_bandwidth_rad_s =
      s.NumberOr("current_bandwidth_rad_s", p->current_bandwidth_rad_s, {1.0, 10000.0});
  p->three_phase = s.BoolOr("three_phase", p->three_phase);
  p->emf_flatness = s.NumberOr("emf_flatness_1", p->emf_flatness, {0.0, 1.0});
  p->ambient_degC = s.NumberOr("ambient_degC", p->ambient_degC);
  p->initial_rise_K = s.NumberOr("initial_rise_K", p->initial_rise_K, {0.0, 150.0});
  p->heat_capacity_J_K = s.NumberOr("heat_capacity_J_K", p->heat_capacity_J_K, kPositive);
  p->thermal_resistance_K_W =
      s.NumberOr("thermal_resistance_K_W", p->thermal_resistance_K_W, kPositive);
  rotor->inertia_kg_m2 = s.NumberOr("rotor_inertia_kg_m2", rotor->inertia_kg_m2, kPositive);
  rotor->viscous_Nm_s_rad = s.NumberOr("viscous_Nm_s_rad", rotor->viscous_Nm_s_rad, kNotNegative);
  ReadSlip(s.ChildOrEmpty("dry_friction"), &rotor->friction);
  const Section d = s.ChildOrEmpty("drive");
  drive->rate_Hz = d.NumberOr("rate_Hz", drive->rate_Hz, {500.0, 24000.0});
  drive->position_gain_1_s =
      d.NumberOr("position_gain_1_s", drive->position_gain_1_s, kNotNegative);
  drive->velocity_gain_Nm_s_rad =
      d.NumberOr("velocity_gain_Nm_s_rad", drive->velocity_gain_Nm_s_rad, kNotNegative);
  drive->velocity_integral_gain_Nm_rad = d.NumberOr(
      "velocity_integral_gain_Nm_rad", drive->velocity_integral_gain_Nm_rad, kNotNegative);
  drive->velocity_limit_rad_s =
      d.NumberOr("velocity_limit_rad_s", drive->velocity_limit_rad_s, kPositive);
  drive->torque_limit_Nm = d.NumberOr("torque_limit_Nm", drive->torque_limit_Nm, kPositive);
  drive->estimator_bandwidth_rad_s =
      d.NumberOr("estimator_bandwidth_rad_s", drive->estimator_bandwidth_rad_s, kPositive);
  d.RejectUnknownKeys();
  s.RejectUnknownKeys();
}

void ReadGear(const Section& s, GearParameters* p) {
  p->ratio = s.NumberOr("ratio_1", p->ratio, kPositive);
  p->play_rad = s.NumberOr("play_rad", p->play_rad, {0.0, 1e6});  // huge: uncoupled
  p->contact_stiffness_Nm_rad =
      s.NumberOr("contact_stiffness_Nm_rad", p->contact_stiffness_Nm_rad, kPositive);
  p->contact_damping_Nm_s_rad =
      s.NumberOr("contact_damping_Nm_s_rad", p->contact_damping_Nm_s_rad, kNotNegative);
  p->damping_depth_rad = s.NumberOr("damping_depth_rad", p->damping_depth_rad, kPositive);
  p->share_drive = s.NumberOr("torque_share_drive_1", p->share_drive, {0.01, 1.0});
  p->share_back = s.NumberOr("torque_share_back_1", p->share_back, {0.01, 2.0});
  p->load_friction = s.NumberOr("load_friction_1", p->load_friction, kNotNegative);
  s.RejectUnknownKeys();
}

void ReadLink(const Section& s, LinkParameters* p) {
  p->inertia_kg_m2 = s.NumberOr("inertia_kg_m2", p->inertia_kg_m2, kPositive);
  p->gravity_torque_Nm = s.NumberOr("gravity_torque_Nm", p->gravity_torque_Nm);
  p->length_m = s.NumberOr("length_m", p->length_m, kPositive);
  p->gravity_m_s2 = s.NumberOr("gravity_m_s2", p->gravity_m_s2, kNotNegative);
  p->viscous_Nm_s_rad = s.NumberOr("viscous_Nm_s_rad", p->viscous_Nm_s_rad, kNotNegative);
  p->declared_payload_kg = s.NumberOr("declared_payload_kg", p->declared_payload_kg, {0.0, 20.0});
  p->end_stop_rad = s.NumberOr("end_stop_rad", p->end_stop_rad, {0.1, 100.0});
  ReadSlip(s.ChildOrEmpty("dry_friction"), &p->friction);
  s.RejectUnknownKeys();
}

void ReadPneumatics(const Section& s, PneumaticParameters* p) {
  p->displacement_m3_rad = s.NumberOr("displacement_m3_rad", p->displacement_m3_rad, kNotNegative);
  p->displacement_shape = s.NumbersOr("displacement_shape_1", p->displacement_shape);
  p->dead_volume_m3 = s.NumberOr("dead_volume_m3", p->dead_volume_m3, kPositive);
  p->chamber_wall_W_K = s.NumberOr("chamber_wall_W_K", p->chamber_wall_W_K, kNotNegative);
  p->reservoir_volume_m3 = s.NumberOr("reservoir_volume_m3", p->reservoir_volume_m3, kPositive);
  p->reservoir_wall_W_K = s.NumberOr("reservoir_wall_W_K", p->reservoir_wall_W_K, kNotNegative);
  p->atmosphere_Pa = s.NumberOr("atmosphere_Pa", p->atmosphere_Pa, {5e4, 1.2e5});
  p->wall_temperature_K = s.NumberOr("wall_temperature_K", p->wall_temperature_K, {200.0, 400.0});
  p->compressor_kg_s = s.NumberOr("compressor_kg_s", p->compressor_kg_s, kNotNegative);
  p->compressor_limit_bar = s.NumberOr("compressor_limit_bar", p->compressor_limit_bar, kPositive);
  p->initial_pressure_bar =
      s.NumberOr("initial_pressure_bar", p->initial_pressure_bar, {0.0, 10.0});
  p->initial_valve_open = s.BoolOr("initial_valve_open", p->initial_valve_open);
  ReadOrifice(s.ChildOrEmpty("valve"), &p->valve);
  ReadOrifice(s.ChildOrEmpty("vent"), &p->vent);
  ReadOrifice(s.ChildOrEmpty("seal_leak"), &p->seal_leak);
  ReadRelay(s.ChildOrEmpty("valve_relay"), &p->valve_relay);
  ReadRelay(s.ChildOrEmpty("compressor_relay"), &p->compressor_relay);
  ReadRelay(s.ChildOrEmpty("vent_relay"), &p->vent_relay);
  s.RejectUnknownKeys();
}

void ReadSensors(const Section& s, SensorParameters* p) {
  p->encoder_counts =
      static_cast<int>(s.IntegerOr("encoder_counts", p->encoder_counts, {16.0, 1e9}));
  p->motor_encoder_noise_rad =
      s.NumberOr("motor_encoder_noise_rad", p->motor_encoder_noise_rad, kNotNegative);
  p->output_encoder_noise_rad =
      s.NumberOr("output_encoder_noise_rad", p->output_encoder_noise_rad, kNotNegative);
  p->output_observer_rad_s =
      s.NumberOr("output_observer_rad_s", p->output_observer_rad_s, kPositive);
  p->current_noise_A = s.NumberOr("current_noise_A", p->current_noise_A, kNotNegative);
  p->load_cell_noise_N = s.NumberOr("load_cell_noise_N", p->load_cell_noise_N, kNotNegative);
  p->pressure_noise_bar = s.NumberOr("pressure_noise_bar", p->pressure_noise_bar, kNotNegative);
  p->pressure_counts =
      static_cast<int>(s.IntegerOr("pressure_counts", p->pressure_counts, {2.0, 1e9}));
  p->pressure_range_bar = s.NumberOr("pressure_range_bar", p->pressure_range_bar, kPositive);
  p->temperature_noise_degC =
      s.NumberOr("temperature_noise_degC", p->temperature_noise_degC, kNotNegative);
  p->temperature_step_degC =
      s.NumberOr("temperature_step_degC", p->temperature_step_degC, kNotNegative);
  p->latch_phase = s.NumberOr("latch_phase_1", p->latch_phase, {0.0, 1.0});
  p->torque_efficiency = s.NumberOr("torque_efficiency_1", p->torque_efficiency, kPositive);
  s.RejectUnknownKeys();
}

}  // namespace

RigParameters ReadRig(const Section& section) {
  RigParameters p;
  ReadMotor(section.ChildOrEmpty("motor"), &p.motor, &p.drive, &p.rotor);
  ReadGear(section.ChildOrEmpty("gear"), &p.gear);
  ReadLink(section.ChildOrEmpty("link"), &p.link);
  ReadPneumatics(section.ChildOrEmpty("pneumatics"), &p.pneumatics);
  ReadSensors(section.ChildOrEmpty("sensors"), &p.sensors);
  p.step_s = section.NumberOr("step_s", p.step_s, {1e-6, 1e-4});
  p.initial_angle_rad = section.NumberOr("initial_angle_rad", p.initial_angle_rad);
  p.initial_rest_s = section.NumberOr("initial_rest_s", p.initial_rest_s, kNotNegative);
  p.rotor_locked = section.BoolOr("rotor_locked", p.rotor_locked);
  p.spread = section.NumberOr("spread_1", p.spread, {0.0, 0.3});
  for (const std::string& text : section.TextsOr("effects", {})) {
    try {
      if (const auto effect = ParseEffect(text)) p.effects.push_back(*effect);
    } catch (const std::invalid_argument& error) {
      section.Fail("effects", error.what());
    }
  }
  try {
    const Rig check(p);
  } catch (const std::invalid_argument& error) {
    throw UsageError(section.file().string() + ": " + error.what());
  }
  return p;
}

Section OpenSurrogate(const std::filesystem::path& path) {
  return path.empty() ? Section::Empty("defaults") : Section::Load(path, kSchema);
}

RigParameters LoadRig(const std::filesystem::path& path) {
  const Section section = OpenSurrogate(path);
  RigParameters rig = ReadRig(section);
  const Section guard = section.ChildOrEmpty("guard");
  for (const std::string& key : guard.Keys()) guard.Has(key);
  section.RejectUnknownKeys();
  return rig;
}

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
