// A drawn rig: mechanics, sensors, motion.
//
// Everything is at the output: rad and Nm, or m and N for a linear axis ("unit" below). The motor's
// angle is gear_ratio times the output's; x = motor angle / gear_ratio.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace sinew::rigs {

enum class Family {
  kSeaPea,
  kDirectDrive,
  kHarmonic,
  kLinear,
  kServo,
  kCylinder,
  kHanging,
  kBelt,
  kQuasiDirect,
  kAirSpring
};
// Rigs from this number on are drawn of the first seven families, with tasks of all kinds; those
// below are of the first six, with tasks from point to point, and stay what they were.
inline constexpr std::uint64_t kSecondDraw = 100000;
// From here on they are of the last three: held back from every choice (LEDGER.md).
inline constexpr std::uint64_t kThirdDraw = 200000;
enum class Coupling { kRigid, kSpring, kPlay };
// What the record calls the drive: motor current, amplifier command in volts, volts on the winding,
// or torque (force) of a sensor between motor and link.
enum class Drive { kCurrent, kCommand, kWinding, kSensor };

const char* WordOf(Family family);

struct Noise {
  double rms = 0.0;
  double correlation = 0.0;  // AR(1) coefficient per row; 0: white
  double step = 0.0;         // quantisation; 0: none
};

struct Rig {
  std::uint64_t number = 0;
  Family family = Family::kSeaPea;
  Coupling coupling = Coupling::kPlay;
  Drive drive = Drive::kCurrent;
  bool linear = false;

  // Time.
  double rate_Hz = 100.0;
  int rows = 6000;          // per recording
  int steps_per_row = 100;  // integration

  // Drive.
  double gear_ratio = 100.0;
  int pole_pairs = 7;
  double torque_constant_Nm_A = 0.016;
  double efficiency = 0.8;
  double current_limit_A = 25.0;
  double current_lag_s = 3e-4;
  double command_gain = 0.0;      // kCommand: unit of force per volt
  double winding_gain = 0.0;      // kWinding: Nm per volt at the output
  double back_emf_V_s_rad = 0.0;  // kWinding: motor side
  double supply_V = 0.0;          // kWinding
  double supply_sag_V_Nm = 0.0;   // kWinding: measured, not an effect

  // Bodies, at the output.
  double rotor_inertia = 0.1;
  double link_inertia = 0.02;
  double motor_viscous = 0.3;
  double link_viscous = 0.0;
  double coulomb = 0.2;
  double bristle = 1e-4;        // displacement at which friction has built up
  double gravity_torque = 0.6;  // 0: none
  double link_length_m = 0.3;
  double offset = 0.0;      // constant force, declared where not 0
  double play = 0.0;        // full width
  double stiffness = 2e4;   // of the teeth or the spring
  double stiffening = 0.0;  // the spring's share more where it carries the typical torque
  double damping = 5.0;

  // Hardware.
  bool motor_encoder = true;   // a column of its own
  bool output_encoder = true;  // else position is the motor's
  bool pressure = false;
  bool load_cell = false;
  bool payloads = false;
  bool temperature = false;
  bool velocities = false;   // columns of the controller's observer
  bool gas_balance = false;  // the model declares the gas
  bool kinematic = false;    // the model declares the balance of the encoders

  // Gas: torque = K P - k1 P (q - q0).
  double pneumatic_slope = 0.0;      // K, Nm/bar
  double pneumatic_stiffness = 0.0;  // k1, Nm/(rad bar)
  double rest_position = 0.0;        // q0
  double gas_volume_m3 = 1e-3;       // at q0
  double gas_wall_time_s = 0.05;
  double valve_flow_m2 = 2e-6;  // sonic conductance times a constant: effective area
  bool valve = false;           // false: the regulator stays connected
  double pressure_max_bar = 5.0;

  // Sensors.
  int motor_bits = 14, output_bits = 14;
  double position_step = 0.0;   // linear scale; 0: output_bits per turn
  double encoder_jitter = 0.3;  // in steps
  double homing = 0.0;          // standard deviation of a recording's zero, at the output
  Noise current, torque, pressure_noise, force;
  double stamp_jitter = 0.01;    // share of a period
  double lost_rows = 0.0;        // share
  std::uint64_t noise_draw = 0;  // another one: other noise on the same motion
  double noise_share = 1.0;      // of everything that the log adds, counts included

  // Motion.
  double centre = 0.0;
  double amplitude = 0.8;
  double frequency_Hz = 0.7;  // of fast motion
  double reference_Hz = 5.0;  // smoothing of the set point
  double bandwidth_Hz = 5.0;  // of the servo
  double payload_kg = 0.0;    // that the designed excitation puts on
  double hand_N = 0.0;        // push at the load cell

  double total_inertia() const { return rotor_inertia + link_inertia; }
  double speed() const;        // typical: 2 pi frequency amplitude
  double force_scale() const;  // typical drive torque
  double row_s() const { return 1.0 / rate_Hz; }
  double step_s() const { return 1.0 / (rate_Hz * steps_per_row); }
};

Rig DrawRig(std::uint64_t number);

}  // namespace sinew::rigs
