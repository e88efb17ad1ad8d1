#include "bench/rigs/drawn/rig.h"

#include <algorithm>
#include <cmath>

#include "bench/rigs/drawn/random.h"
#include "components/base/types/angle.h"

namespace sinew::rigs {
namespace {

using types::kPi;
constexpr double kGravity = 9.81;

// Bodies and friction from a typical gravity torque and swing: ratios are drawn, the scale is
// given.
void DrawRotaryBodies(Rig& rig, Random& random, double scale, double gravity_Nm) {
  rig.gravity_torque = scale * gravity_Nm;
  rig.link_length_m = random.Uniform(0.15, 0.5) * std::pow(scale, 0.2);
  rig.link_inertia = rig.gravity_torque / kGravity * rig.link_length_m * random.Uniform(0.5, 1.2);
}

void DrawSeaPea(Rig& rig, Random& random, double scale) {
  rig.coupling = Coupling::kPlay;
  rig.gear_ratio = std::round(random.LogUniform(20.0, 160.0));
  DrawRotaryBodies(rig, random, scale, 0.6);
  rig.rotor_inertia = rig.link_inertia * random.LogUniform(1.5, 8.0);
  rig.motor_viscous = rig.rotor_inertia * random.Uniform(1.5, 4.0);
  rig.coulomb = rig.gravity_torque * random.Uniform(0.2, 0.5);
  rig.play = random.LogUniform(0.008, 0.05);
  rig.pressure = rig.load_cell = rig.valve = true;
  rig.payloads = random.Chance(0.85);
  rig.temperature = random.Chance(0.7);
  rig.velocities = random.Chance(0.7);
  rig.kinematic = random.Chance(0.7);
  rig.pneumatic_slope = rig.gravity_torque * random.Uniform(0.3, 0.8);
  rig.pneumatic_stiffness = rig.gravity_torque * random.LogUniform(0.5, 6.0);
  rig.rest_position = random.Uniform(-0.2, 0.2);
  // The chamber keeps two fifths of its volume at least over the whole swing.
  const double change = 1e-5 * (1.5 * rig.pneumatic_slope + 1.1 * rig.pneumatic_stiffness);
  rig.gas_volume_m3 = std::max(random.LogUniform(2e-4, 3e-3) * scale, 1.7 * change);
  rig.gas_wall_time_s = random.LogUniform(0.01, 0.06);
  rig.valve_flow_m2 = rig.gas_volume_m3 * random.LogUniform(0.02, 0.1);
  rig.pressure_max_bar = random.Uniform(3.0, 6.5);
  rig.amplitude = random.Uniform(0.5, 1.1);
  rig.frequency_Hz = random.LogUniform(0.3, 0.8);
}

void DrawDirectDrive(Rig& rig, Random& random, double scale) {
  rig.coupling = Coupling::kRigid;
  rig.gear_ratio = 1.0;
  const bool pendulum = random.Chance(0.7);
  DrawRotaryBodies(rig, random, scale, 0.8);
  if (!pendulum) rig.gravity_torque = 0.0;
  rig.rotor_inertia = rig.link_inertia * random.Uniform(0.1, 0.5);
  rig.motor_viscous = 0.0;
  rig.link_viscous = rig.total_inertia() * random.Uniform(0.3, 2.0);
  rig.coulomb = rig.link_inertia / 0.02 * random.Uniform(0.01, 0.06);
  rig.output_encoder = false;
  rig.payloads = pendulum && random.Chance(0.5);
  rig.temperature = random.Chance(0.4);
  rig.amplitude = random.Uniform(0.6, 1.3);
  rig.frequency_Hz = random.LogUniform(0.4, 1.5);
}

void DrawHarmonic(Rig& rig, Random& random, double scale) {
  rig.coupling = Coupling::kSpring;
  rig.gear_ratio = random.Integer(2, 8) * 20.0;
  DrawRotaryBodies(rig, random, scale, 8.0);
  rig.rotor_inertia = rig.link_inertia * random.LogUniform(0.3, 3.0);
  rig.motor_viscous = rig.rotor_inertia * random.Uniform(2.0, 6.0);
  rig.coulomb = rig.gravity_torque * random.Uniform(0.08, 0.3);
  if (random.Chance(0.45)) {
    rig.drive = Drive::kSensor;
    rig.link_viscous = rig.link_inertia * random.Uniform(0.5, 2.0);
    rig.coulomb *= 0.4;
  } else {
    rig.kinematic = random.Chance(0.5);
  }
  rig.payloads = random.Chance(0.6);
  rig.temperature = random.Chance(0.5);
  rig.amplitude = random.Uniform(0.4, 1.2);
  rig.frequency_Hz = random.LogUniform(0.25, 0.8);
}

void DrawLinear(Rig& rig, Random& random, double scale) {
  rig.linear = true;
  rig.coupling = random.Chance(0.5) ? Coupling::kRigid : Coupling::kSpring;
  rig.gear_ratio = 2.0 * kPi / random.LogUniform(0.004, 0.03);
  rig.gravity_torque = 0.0;
  const double mass_kg = 20.0 * scale;
  rig.rotor_inertia = mass_kg * random.Uniform(0.3, 1.5);
  rig.link_inertia = mass_kg;
  rig.link_viscous = rig.total_inertia() * random.Uniform(0.8, 3.0);
  rig.motor_viscous = 0.0;
  rig.coulomb = rig.total_inertia() * random.Uniform(0.15, 0.6);
  rig.offset = rig.coulomb * random.Uniform(-0.3, 0.3);
  if (random.Chance(0.35)) rig.drive = Drive::kCommand;
  rig.motor_encoder = rig.drive == Drive::kCurrent;
  rig.output_encoder = random.Chance(0.5);
  rig.temperature = random.Chance(0.4);
  rig.amplitude = random.LogUniform(0.04, 0.25);
  rig.frequency_Hz = random.LogUniform(0.3, 1.2);
}

void DrawServo(Rig& rig, Random& random, double scale) {
  rig.coupling = Coupling::kRigid;
  rig.drive = Drive::kWinding;
  rig.gear_ratio = 1.0;  // as servos report: everything at the output shaft
  DrawRotaryBodies(rig, random, scale, 0.45);
  rig.rotor_inertia = rig.link_inertia * random.Uniform(0.1, 0.6);
  rig.motor_viscous = 0.0;
  rig.link_viscous = rig.total_inertia() * random.Uniform(0.3, 2.0);
  rig.coulomb = rig.gravity_torque * random.Uniform(0.05, 0.2);
  rig.output_encoder = false;
  rig.motor_encoder = false;
  rig.temperature = random.Chance(0.7);
  rig.supply_V = random.Uniform(5.0, 24.0);
  rig.winding_gain = rig.gravity_torque * random.Uniform(2.5, 5.0) / rig.supply_V;
  rig.back_emf_V_s_rad = rig.supply_V / random.Uniform(8.0, 25.0);
  rig.supply_sag_V_Nm = rig.supply_V * random.Uniform(0.0, 0.05) / rig.gravity_torque;
  rig.amplitude = random.Uniform(0.5, 1.1);
  rig.frequency_Hz = random.LogUniform(0.3, 0.9);
}

void DrawCylinder(Rig& rig, Random& random, double scale) {
  rig.linear = true;
  rig.coupling = Coupling::kSpring;
  rig.drive = Drive::kSensor;
  rig.gear_ratio = 2.0 * kPi / random.LogUniform(0.002, 0.01);
  rig.gravity_torque = 0.0;
  const double area_N_bar = 49.0 * scale;
  rig.link_inertia = 2.0 * scale;
  rig.coulomb = area_N_bar * random.Uniform(0.05, 0.2);
  rig.pressure = true;
  rig.motor_encoder = false;
  rig.pneumatic_slope = area_N_bar;
  rig.amplitude = random.LogUniform(0.01, 0.05);
  rig.rest_position = -1.3 * rig.amplitude;
  rig.gas_volume_m3 = 1e-5 * area_N_bar * rig.amplitude * random.Uniform(2.5, 8.0);
  rig.gas_wall_time_s = random.LogUniform(0.02, 0.2);
  rig.valve_flow_m2 = rig.gas_volume_m3 * random.LogUniform(0.03, 0.2);
  rig.pressure_max_bar = random.Uniform(2.0, 5.0);
  rig.frequency_Hz = random.LogUniform(0.1, 0.5);
  rig.link_viscous = rig.coulomb / rig.speed() * random.Uniform(0.2, 0.8);
  // A stage that the pressure hardly moves: its screw's inertia is large at the output.
  const double omega = 2.0 * kPi * 8.0;
  rig.rotor_inertia = 6.0 * area_N_bar * rig.pressure_max_bar / (rig.amplitude * omega * omega);
  rig.motor_viscous = rig.rotor_inertia;
}

// A motor far from its joint: a toothed belt that is soft and stiffens as it is pulled.
void DrawBelt(Rig& rig, Random& random, double scale) {
  rig.coupling = Coupling::kSpring;
  rig.gear_ratio = random.Uniform(2.0, 8.0);
  DrawRotaryBodies(rig, random, scale, 2.0);
  if (random.Chance(0.4)) rig.gravity_torque = 0.0;
  rig.rotor_inertia = rig.link_inertia * random.LogUniform(0.1, 1.0);
  rig.motor_viscous = rig.rotor_inertia * random.Uniform(1.0, 4.0);
  rig.link_viscous = rig.link_inertia * random.Uniform(0.3, 1.5);
  rig.coulomb = rig.link_inertia * random.Uniform(0.5, 2.0);
  rig.stiffening = random.Uniform(0.1, 0.6);
  rig.payloads = rig.gravity_torque > 0.0 && random.Chance(0.5);
  rig.temperature = random.Chance(0.4);
  rig.velocities = random.Chance(0.5);
  rig.amplitude = random.Uniform(0.5, 1.4);
  rig.frequency_Hz = random.LogUniform(0.3, 1.0);
}

// One or two planet stages with little play, homed anew for every recording.
void DrawQuasiDirect(Rig& rig, Random& random, double scale) {
  rig.coupling = Coupling::kPlay;
  rig.gear_ratio = random.Uniform(5.0, 12.0);
  DrawRotaryBodies(rig, random, scale, 4.0);
  rig.rotor_inertia = rig.link_inertia * random.LogUniform(0.1, 0.8);
  rig.motor_viscous = rig.rotor_inertia * random.Uniform(1.0, 4.0);
  rig.coulomb = rig.gravity_torque * random.Uniform(0.03, 0.12);
  rig.play = random.LogUniform(0.001, 0.005);
  rig.kinematic = random.Chance(0.5);
  rig.payloads = random.Chance(0.6);
  rig.temperature = random.Chance(0.5);
  rig.velocities = random.Chance(0.5);
  rig.homing = random.LogUniform(0.001, 0.01);
  rig.amplitude = random.Uniform(0.5, 1.1);
  rig.frequency_Hz = random.LogUniform(0.4, 1.2);
}

// A rigid worm or cycloid whose weight a chamber at a regulated pressure carries in part.
void DrawAirSpring(Rig& rig, Random& random, double scale) {
  rig.coupling = Coupling::kRigid;
  rig.gear_ratio = std::round(random.LogUniform(10.0, 50.0));
  DrawRotaryBodies(rig, random, scale, 5.0);
  rig.rotor_inertia = rig.link_inertia * random.LogUniform(0.5, 3.0);
  rig.motor_viscous = 0.0;
  rig.link_viscous = rig.total_inertia() * random.Uniform(0.5, 3.0);
  rig.coulomb = rig.gravity_torque * random.Uniform(0.1, 0.35);
  rig.output_encoder = false;
  rig.pressure = true;
  rig.pneumatic_slope = rig.gravity_torque * random.Uniform(0.15, 0.4);
  rig.pneumatic_stiffness = rig.pneumatic_slope * random.LogUniform(0.1, 1.0);
  rig.rest_position = random.Uniform(-0.3, 0.3);
  const double change = 1e-5 * (1.5 * rig.pneumatic_slope + 1.1 * rig.pneumatic_stiffness);
  rig.gas_volume_m3 = change * random.Uniform(2.0, 6.0);
  rig.gas_wall_time_s = random.LogUniform(0.02, 0.2);
  rig.valve_flow_m2 = rig.gas_volume_m3 * random.LogUniform(0.03, 0.2);
  rig.pressure_max_bar = random.Uniform(2.0, 5.0);
  rig.payloads = random.Chance(0.5);
  rig.temperature = random.Chance(0.5);
  rig.amplitude = random.Uniform(0.4, 1.0);
  rig.frequency_Hz = random.LogUniform(0.2, 0.7);
}

void DrawSensors(Rig& rig, Random& random) {
  rig.motor_bits = random.Integer(12, 20);
  rig.output_bits = random.Integer(12, 20);
  // A servo or direct drive has one encoder; 12 bits of it at 1 kHz hide every acceleration.
  if (rig.family == Family::kServo) rig.output_bits = random.Integer(12, 14);
  if (rig.linear) rig.position_step = rig.amplitude / random.LogUniform(4e3, 2e5);
  rig.encoder_jitter = random.Uniform(0.1, 0.6);
  const double force = rig.force_scale();
  const double level = random.LogUniform(0.01, 0.06);
  const double colour = random.Chance(0.5) ? random.Uniform(0.5, 0.97) : 0.0;
  const double per_A = rig.gear_ratio * rig.torque_constant_Nm_A * rig.efficiency;
  const double unit = rig.drive == Drive::kCommand   ? rig.command_gain
                      : rig.drive == Drive::kWinding ? rig.winding_gain
                                                     : per_A;
  const double step = rig.current_limit_A / std::exp2(random.Integer(10, 14));
  rig.current = {level * force / unit, colour, rig.drive == Drive::kCurrent ? step : 0.0};
  rig.torque = {level * force, colour, 0.0};
  rig.pressure_noise = {rig.pressure_max_bar * random.LogUniform(3e-4, 2e-3), 0.0,
                        10.0 / std::exp2(random.Integer(10, 14))};
  if (rig.load_cell) rig.force = {rig.hand_N * random.LogUniform(2e-3, 2e-2), 0.0, 0.0};
  rig.stamp_jitter = random.LogUniform(1e-3, 3e-2);
  rig.lost_rows = random.Chance(0.5) ? random.LogUniform(5e-4, 1e-2) : 0.0;
}

// Rows are in the order of Family.
constexpr struct {
  const char* word;
  void (*draw)(Rig& rig, Random& random, double scale);
} kFamilies[] = {
    {"sea_pea", DrawSeaPea},
    {"direct_drive", DrawDirectDrive},
    {"harmonic", DrawHarmonic},
    {"linear", DrawLinear},
    {"servo", DrawServo},
    {"cylinder", DrawCylinder},
    {"hanging", DrawSeaPea},
    {"belt", DrawBelt},
    {"quasi_direct", DrawQuasiDirect},
    {"air_spring", DrawAirSpring},
};

}  // namespace

const char* WordOf(Family family) { return kFamilies[static_cast<std::size_t>(family)].word; }

double Rig::speed() const { return 2.0 * kPi * frequency_Hz * amplitude; }

double Rig::force_scale() const {
  const double omega = 2.0 * kPi * frequency_Hz;
  const bool sensor = drive == Drive::kSensor;  // sees nothing of the motor's side
  const double inertia = sensor ? link_inertia : total_inertia();
  const double viscous = link_viscous + (sensor ? 0.0 : motor_viscous);
  return 0.5 * gravity_torque + coulomb + 0.7 * inertia * amplitude * omega * omega +
         0.7 * viscous * speed() + 0.3 * pneumatic_slope * pressure_max_bar;
}

Rig DrawRig(std::uint64_t number) {
  Random random(number, 0);
  Rig rig;
  rig.number = number;
  // As many rigs of each of the draw's families, in a drawn order.
  const bool third = number >= kThirdDraw;
  const std::uint64_t families = third ? 3 : number < kSecondDraw ? 6 : 7;
  const auto drawn = static_cast<std::uint64_t>(
      Random(number / families, 77).Integer(0, static_cast<int>(families) - 1));
  rig.family =
      static_cast<Family>((number + drawn) % families +
                          static_cast<std::uint64_t>(third ? Family::kBelt : Family::kSeaPea));
  const double scale = random.LogUniform(0.1, 10.0);
  rig.rate_Hz = std::round(random.LogUniform(50.0, 1000.0));
  kFamilies[static_cast<std::size_t>(rig.family)].draw(rig, random, scale);

  // A slow log is not asked for fast motion. Durations stay within 10 to 300 s.
  rig.frequency_Hz = std::min(rig.frequency_Hz, rig.rate_Hz / 100.0);
  const double wanted = random.LogUniform(4000.0, 14000.0);
  const double shortest_s = std::max(10.0, 12.0 / rig.frequency_Hz);
  const double duration_s = std::max(shortest_s, std::min(wanted / rig.rate_Hz, 100.0));
  rig.rows = std::min(40000, static_cast<int>(duration_s * rig.rate_Hz));
  rig.steps_per_row = std::max(10, static_cast<int>(std::ceil(5000.0 / rig.rate_Hz)));

  rig.pole_pairs = random.Integer(5, 21);
  rig.efficiency = rig.coupling == Coupling::kRigid ? 1.0 : random.Uniform(0.6, 0.9);
  rig.current_limit_A = random.LogUniform(2.0, 40.0);
  // The set point is smoothed to what the log can show; the servo behind it is faster.
  rig.reference_Hz = std::clamp(5.0 * rig.frequency_Hz, 2.0, rig.rate_Hz / 25.0);
  const double faster = random.LogUniform(1.5, 5.0);
  rig.bandwidth_Hz = rig.family == Family::kCylinder ? 8.0
                     : rig.family == Family::kServo  ? rig.reference_Hz
                                                     : faster * rig.reference_Hz;
  rig.centre = rig.linear || rig.gravity_torque == 0.0 ? 0.0 : random.Uniform(-0.25, 0.25);
  if (rig.family == Family::kHanging) {
    rig.centre -= 0.5 * kPi;
    rig.rest_position += rig.centre;
    rig.pneumatic_slope *= 0.2;  // the load changes its sign
  }
  if (rig.payloads) {
    const double arm = kGravity * rig.link_length_m;
    rig.payload_kg =
        std::max(0.3 * rig.gravity_torque, 0.3 * rig.coulomb) / arm * random.Uniform(0.6, 1.5);
  }
  // The drive reaches three times the typical torque at its limit.
  const double omega_fast = 2.0 * kPi * rig.frequency_Hz;
  const double motor_side =
      rig.rotor_inertia * rig.amplitude * omega_fast * omega_fast + rig.motor_viscous * rig.speed();
  const double peak =
      3.0 * (rig.force_scale() + motor_side + 9.81 * rig.link_length_m * rig.payload_kg +
             rig.pneumatic_slope * rig.pressure_max_bar);
  rig.torque_constant_Nm_A = peak / (rig.current_limit_A * rig.gear_ratio * rig.efficiency);
  rig.command_gain = peak / 10.0;
  if (rig.load_cell) rig.hand_N = 0.5 * rig.force_scale() / rig.link_length_m;

  // Contact and friction that the step resolves.
  const double reduced = rig.rotor_inertia * rig.link_inertia / rig.total_inertia();
  const double fastest = 0.35 / rig.step_s();
  const double wanted_Hz = rig.coupling == Coupling::kPlay ? random.LogUniform(120.0, 250.0)
                           : rig.stiffening > 0.0
                               ? random.LogUniform(20.0, 80.0)
                               : std::max(80.0, rig.rate_Hz * 0.4) * random.LogUniform(1.0, 2.0);
  const double omega = std::min(fastest, 2.0 * kPi * wanted_Hz);
  rig.stiffness = reduced * omega * omega;
  rig.damping = 2.0 * random.Uniform(0.1, 0.3) * reduced * omega;
  const double body = rig.coupling == Coupling::kRigid ? rig.total_inertia() : rig.link_inertia;
  rig.bristle = std::max(rig.amplitude * random.LogUniform(3e-6, 3e-5),
                         rig.coulomb / (body * fastest * fastest));
  rig.gas_balance = rig.valve && Random(number, 55).Chance(0.6);
  DrawSensors(rig, random);
  return rig;
}

}  // namespace sinew::rigs
