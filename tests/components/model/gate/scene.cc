#include "tests/components/model/gate/scene.h"

#include <algorithm>
#include <cmath>

#include "sim/surrogate/experiment.h"
#include "sim/surrogate/random.h"
#include "sim/surrogate/rig.h"

namespace sinew::scene {
namespace {

using surrogate::ExcitationKind;
using surrogate::RandomStream;
using surrogate::RigParameters;
using types::Signal;

constexpr double kRestAngle_rad = 0.16;
constexpr double kStateCutoff_Hz = 20.0;
constexpr double kNoiseMemory_s = 0.1;
enum BankStream : std::uint64_t { kStreamDeclared = 900, kStreamTimes, kStreamColoured };

// The lab's rig: a pneumatic element that pulls back to an angle, a chamber with its reservoir of
// 2.1 litres behind a valve to a regulator, walls that keep it at one temperature.
RigParameters LabRig() {
  RigParameters rig;
  rig.pneumatics.displacement_shape = {29.059,   25.7747,  22.4903,  19.206,   15.9216, 12.6373,
                                       9.3529,   6.0686,   2.7842,   -0.5001,  -3.7845, -7.0688,
                                       -10.3532, -13.6375, -16.9219, -20.2062, -23.4906};
  rig.pneumatics.dead_volume_m3 = 2e-3;
  rig.pneumatics.chamber_wall_W_K = 100.0;
  rig.pneumatics.reservoir_volume_m3 = 1e-3;
  rig.pneumatics.valve.conductance_m3_sPa = 2e-8;
  rig.pneumatics.vent.conductance_m3_sPa = 8e-9;
  rig.pneumatics.compressor_kg_s = 1.2e-2;
  rig.spread = 0.08;
  return rig;
}

types::Run ToRun(const std::vector<surrogate::LogRow>& rows, const std::string& name) {
  types::Run run;
  run.name = name;
  run.kind = types::JointKind::kRevolute;
  const auto n = static_cast<Eigen::Index>(rows.size());
  run.time_s.resize(n);
  const auto fill = [&](Signal signal, auto value) {
    Eigen::VectorXd& column = run.signals[signal];
    column.resize(n);
    for (Eigen::Index i = 0; i < n; ++i) column[i] = value(rows[static_cast<std::size_t>(i)]);
  };
  for (Eigen::Index i = 0; i < n; ++i) run.time_s[i] = rows[static_cast<std::size_t>(i)].time_s;
  using Row = surrogate::LogRow;
  fill(Signal::kPosition, [](const Row& r) { return r.output_angle_rad; });
  fill(Signal::kVelocity, [](const Row& r) { return r.output_velocity_rad_s; });
  fill(Signal::kMotorPosition, [](const Row& r) { return r.motor_angle_rad; });
  fill(Signal::kMotorVelocity, [](const Row& r) { return r.motor_velocity_rad_s; });
  fill(Signal::kMotorCurrent, [](const Row& r) { return r.motor_current_A; });
  fill(Signal::kChamberPressure, [](const Row& r) { return r.chamber_pressure_bar; });
  fill(Signal::kLoadForce, [](const Row& r) { return r.load_force_N; });
  fill(Signal::kValveOpen, [](const Row& r) { return r.valve_open ? 1.0 : 0.0; });
  fill(Signal::kPayload, [](const Row& r) { return r.payload_kg; });
  fill(Signal::kTemperature, [](const Row& r) { return r.motor_temperature_degC; });
  return run;
}

// Of the chamber with its dead volume, by the table of its displacement.
double ChamberVolume_m3(const RigParameters& rig, double angle_rad) {
  const std::vector<double>& shape = rig.pneumatics.displacement_shape;
  const double step_rad = 2.0 * rig.link.end_stop_rad / static_cast<double>(shape.size() - 1);
  double volume_m3 = rig.pneumatics.dead_volume_m3;
  double at_rad = -rig.link.end_stop_rad;
  for (std::size_t i = 0; i + 1 < shape.size() && at_rad < angle_rad; ++i, at_rad += step_rad) {
    const double part = std::min(1.0, (angle_rad - at_rad) / step_rad);
    const double end = shape[i] + part * (shape[i + 1] - shape[i]);
    volume_m3 += rig.pneumatics.displacement_m3_rad * 0.5 * (shape[i] + end) * part * step_rad;
  }
  return volume_m3;
}

// The declared balance of docs/model.md with the specimen's own values.
actuator::JointModel TrueModel(const RigParameters& rig) {
  actuator::JointModel model;
  model.name = "joint";
  model.constants.gear_ratio = rig.gear.ratio;
  model.constants.link_length_m = rig.link.length_m;
  model.constants.gravity_m_s2 = rig.link.gravity_m_s2;
  model.constants.torque_constant_Nm_A = rig.motor.torque_constant_Nm_A;
  model.constants.encoder_counts_per_turn = rig.sensors.encoder_counts;
  model.constants.gas_volume_m3 = ChamberVolume_m3(rig, kRestAngle_rad);
  model.constants.atmosphere_bar = 1e-5 * rig.pneumatics.atmosphere_Pa;
  model.constants.valve_delay_s =
      rig.pneumatics.valve_relay.on_delay_s + 0.5 * rig.pneumatics.valve_relay.travel_s;
  model.backlash_rad = rig.gear.play_rad;
  model.motor_torque_limit_Nm = rig.drive.torque_limit_Nm;
  const auto add = [&](const char* effect, double value) {
    actuator::Term term = actuator::MakeTerm(effect, model.constants);
    term.linear.front().value = value;
    model.terms.push_back(std::move(term));
  };
  const auto add_exact = [&](const char* effect) {
    add(effect, 1.0);
    model.terms.back().linear.front().fixed = true;
  };
  const double ratio_2 = rig.gear.ratio * rig.gear.ratio;
  const surrogate::PneumaticLine line = surrogate::LinePneumatics(rig);
  add("drive_current", rig.gear.share_drive);
  add("rotor_inertia", rig.rotor.inertia_kg_m2 * ratio_2);
  add("link_inertia", rig.link.inertia_kg_m2);
  add_exact("declared_payload");
  add("motor_viscous", rig.rotor.viscous_Nm_s_rad * ratio_2);
  add("coulomb", rig.link.friction.kinetic_Nm + rig.rotor.friction.kinetic_Nm * rig.gear.ratio);
  add("gravity", rig.link.gravity_torque_Nm);
  // P (slope - stiffness q) = P (K - stiffness (q - q0)).
  add("pneumatic_torque", line.slope_Nm_bar - line.stiffness_Nm_rad_bar * kRestAngle_rad);
  add("pneumatic_stiffness", line.stiffness_Nm_rad_bar);
  model.terms.back().nonlinear.front().value = kRestAngle_rad;
  model.terms.back().nonlinear.front().fixed = true;
  add_exact("load_force");
  // Both encoders, and the gas: chamber and reservoir at one temperature.
  add_exact("encoder_difference");
  add_exact("free_play");
  model.terms.back().linear[0].value = rig.gear.play_rad;
  model.terms.back().linear[1] = {.value = 1.0 / rig.gear.contact_stiffness_Nm_rad,
                                  .fixed = true,
                                  .half_width_95 = std::nullopt};
  add("encoder_offset", 0.0);
  add_exact("chamber_pressure");
  add("gas_compression", 1.0);
  add_exact("valve_flow");
  return model;
}

// What a laboratory states: every value 5 to 15 % off.
actuator::JointModel Declare(actuator::JointModel model, std::uint64_t seed) {
  RandomStream random(seed, kStreamDeclared);
  for (actuator::Term& term : model.terms) {
    for (std::vector<actuator::ParameterValue>* values : {&term.linear, &term.nonlinear}) {
      for (actuator::ParameterValue& value : *values) {
        if (value.fixed && values == &term.linear) continue;
        const double side = random.Uniform() < 0.5 ? -1.0 : 1.0;
        value.value *= 1.0 + side * random.Uniform(0.05, 0.15);
        value.tolerance = 0.15;
      }
    }
  }
  return model;
}

void AddColouredNoise(double size_A, std::uint64_t seed, types::Run* run) {
  RandomStream random(seed, kStreamColoured);
  Eigen::VectorXd& current = run->signals[Signal::kMotorCurrent];
  double noise_A = size_A * random.Gaussian();
  for (Eigen::Index i = 0; i < current.size(); ++i) {
    const double step_s = i == 0 ? 0.0 : run->time_s[i] - run->time_s[i - 1];
    const double kept = std::exp(-step_s / kNoiseMemory_s);
    noise_A = kept * noise_A + size_A * std::sqrt(1.0 - kept * kept) * random.Gaussian();
    current[i] += noise_A;
  }
}

}  // namespace

Recorded Record(const Scene& scene) {
  RigParameters rig = LabRig();
  rig.seed = scene.seed;
  rig = surrogate::Specimen(rig);
  if (scene.silent) {
    rig.sensors.motor_encoder_noise_rad = rig.sensors.output_encoder_noise_rad = 0.0;
    rig.sensors.current_noise_A = rig.sensors.load_cell_noise_N = 0.0;
    rig.sensors.pressure_noise_bar = rig.sensors.temperature_noise_degC = 0.0;
    rig.sensors.temperature_step_degC = 0.0;
    rig.sensors.encoder_counts = 1 << 26;
    rig.sensors.pressure_counts = 1 << 26;
  }
  Recorded out;
  out.specimen = TrueModel(rig);
  out.declared = Declare(out.specimen, scene.seed);
  // As robots/rig/model.yaml.
  out.processing.state_cutoff_Hz = kStateCutoff_Hz;
  out.processing.parallel_cutoff_Hz = 5.0;
  out.processing.rest_velocity = 0.04;
  out.processing.settle_distance = 0.005;
  out.processing.reversal_guard_s = 0.16;

  const bool designed = scene.excitation == ExcitationKind::kDesigned;
  const surrogate::PneumaticLine line = surrogate::LinePneumatics(rig);
  for (int k = 0; k <= scene.trains; ++k) {
    const bool held_out = k == scene.trains;
    if (held_out && !scene.held_out) break;
    const std::uint64_t seed = 1000 * scene.seed + static_cast<std::uint64_t>(k);
    RigParameters run_rig = rig;
    run_rig.seed = seed;
    run_rig.effects = scene.effects;
    RandomStream times(seed, kStreamTimes);
    for (surrogate::EffectSpec& effect : run_rig.effects) {
      const double share = times.Uniform(0.3, 0.7);
      if (effect.name == "payload_step" || effect.name == "external_bump") {
        effect.from_s = share * scene.seconds;
      }
    }
    if (designed) {
      run_rig.link.declared_payload_kg = k % 2 == 1 ? 0.5 : 0.0;
      constexpr double kRise_K[] = {0.0, 25.0, 12.0, 18.0};
      run_rig.motor.initial_rise_K = kRise_K[k % 4];
    }
    const surrogate::Excitation excitation(
        {.kind = scene.excitation,
         .duration_s = scene.seconds,
         .payload_kg = run_rig.link.declared_payload_kg,
         .pneumatic_Nm_bar = line.slope_Nm_bar,
         .pneumatic_stiffness_Nm_rad_bar = line.stiffness_Nm_rad_bar,
         .seed = seed});
    excitation.Prepare(&run_rig);
    surrogate::ExperimentOptions options{.duration_s = scene.seconds,
                                         .cycle_Hz = scene.cycle_Hz,
                                         .log_every = scene.log_every,
                                         .seed = seed};
    if (scene.silent) options.jitter_s = options.stamp_error_s = options.lost_share = 0.0;
    types::Run run = ToRun(surrogate::RunExperiment(run_rig, options, excitation),
                           (held_out ? "held_out" : "train_" + std::to_string(k + 1)) +
                               std::string("_seed_") + std::to_string(scene.seed));
    if (scene.coloured_noise_A > 0.0) AddColouredNoise(scene.coloured_noise_A, seed, &run);
    (held_out ? out.held_out : out.train).push_back(std::move(run));
  }
  return out;
}

}  // namespace sinew::scene
