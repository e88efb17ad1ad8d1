// Every number of the rig that the surrogate plays, with its default. Sources: the thesis (T), data
// sheets (D), or chosen because nothing was published (C). docs/participants/surrogate.md gives
// which published facts follow from them.
#pragma once

#include <cstdint>
#include <vector>

#include "components/base/types/gravity.h"
#include "sim/surrogate/drive.h"
#include "sim/surrogate/gas.h"
#include "sim/surrogate/motor.h"
#include "sim/surrogate/slip.h"
#include "sim/surrogate/undeclared.h"

namespace sinew::surrogate {

struct RotorParameters {
  double inertia_kg_m2 = 1.15e-5;    // C: rotor and first gear stage; 0.115 kg m2 at the output
  double viscous_Nm_s_rad = 3.1e-5;  // C: 0.31 N m s/rad at the output
  SlipParameters friction{.kinetic_Nm = 5e-5,  // C: 0.005 N m at the output
                          .rest_growth_Nm = 0.0,
                          .rest_time_s = 10.0,
                          .renewal_distance_rad = 0.1,
                          .presliding_rad = 2e-3,
                          .presliding_damping_s = 2e-3};
};

struct GearParameters {
  double ratio = 100.0;                   // T
  double play_rad = 0.04642575810304917;  // T: 2.66 degrees at the output, full width
  double contact_stiffness_Nm_rad = 2e4;  // C: teeth and shafts, at the output
  double contact_damping_Nm_s_rad = 10.0;
  double damping_depth_rad = 2e-5;  // damping grows from 0 over this depth: no jump at touch
  // Share of the air-gap torque that reaches the teeth. Equal both ways is what the lab's declared
  // model says; a gear that loses the same share when driven backwards has share_back = 1 /
  // share_drive.
  double share_drive = 0.77;   // T: power from the motor to the output
  double share_back = 0.77;    // C: power from the output to the motor
  double load_friction = 0.0;  // rotor friction per tooth torque / ratio
};

struct LinkParameters {
  double inertia_kg_m2 = 0.019;     // C: with the shaft and vane of the pneumatic element
  double gravity_torque_Nm = 0.58;  // T: at 0 rad (horizontal)
  double length_m = 0.3;            // T: load cell and payload
  double gravity_m_s2 = types::kGravity_m_s2;
  double viscous_Nm_s_rad = 0.0;
  double declared_payload_kg = 0.0;
  double end_stop_rad = 2.356194490192345;  // T: 270 degrees of travel, half to each side
  double end_stop_stiffness_Nm_rad = 5e3;
  double end_stop_damping_Nm_s_rad = 5.0;
  SlipParameters friction{};  // T: 0.22 N m sliding, 1.22 after rest: bearings, seal, gear
};

struct PneumaticParameters {
  // dV/dq at equal steps over the travel, as a share of displacement_m3_rad: a vane whose lever
  // shortens a little toward the end of the travel.
  double displacement_m3_rad = 3.587e-6;  // T: 0.3587 N m/bar
  std::vector<double> displacement_shape{1.038, 1.034, 1.029, 1.024, 1.020, 1.015,
                                         1.010, 1.005, 1.000, 0.995, 0.990, 0.985,
                                         0.981, 0.976, 0.971, 0.966, 0.962};
  double dead_volume_m3 = 3e-7;       // C: chamber at its lower stop, with its fitting
  double chamber_wall_W_K = 0.15;     // C: G of the chamber
  double reservoir_volume_m3 = 2e-3;  // T
  double reservoir_wall_W_K = 4.0;    // C
  double atmosphere_Pa = 101300.0;
  double wall_temperature_K = 296.15;
  Orifice valve{1.5e-9, 0.3};         // C: solenoid valve with its hose
  Orifice vent{4.4e-10, 0.5};         // C: 6 bar falls to a tenth in about 100 s, as in Fig 5.5
  Orifice seal_leak{4e-14, 0.5};      // C: chamber to the other side of the vane
  double compressor_kg_s = 7e-4;      // C: at 0 bar; 36 litres a minute
  double compressor_limit_bar = 8.0;  // delivers nothing at this pressure
  RelayParameters valve_relay{0.015, 0.010, 0.004};
  RelayParameters compressor_relay{0.020, 0.020, 0.15};  // motor spins up and down
  RelayParameters vent_relay{0.012, 0.010, 0.004};
  double initial_pressure_bar = 4.0;  // chamber and reservoir, gauge
  bool initial_valve_open = true;
};

struct SensorParameters {
  int encoder_counts = 16384;             // T: 14 bits, both encoders
  double motor_encoder_noise_rad = 2e-4;  // C
  double output_encoder_noise_rad = 1.5e-4;
  double output_observer_rad_s = 100.0;  // C: bandwidth of the output's velocity estimate
  double current_noise_A = 0.03;
  double load_cell_noise_N = 0.05;
  double pressure_noise_bar = 0.006;
  int pressure_counts = 1024;  // T: 10 bits
  double pressure_range_bar = 10.0;
  double temperature_noise_degC = 0.1;
  double temperature_step_degC = 0.1;
  double latch_phase = 0.5;  // C: when in a cycle the drive latches its readings, 0 to 1
  double torque_efficiency =
      0.77;  // for the torque computed from the current: data sheet, not truth
};

struct RigParameters {
  MotorParameters motor;
  DriveParameters drive;
  RotorParameters rotor;
  GearParameters gear;
  LinkParameters link;
  PneumaticParameters pneumatics;
  SensorParameters sensors;
  std::vector<EffectSpec> effects;  // undeclared
  double step_s = 1.0 / 24000.0;    // longest internal step
  double initial_angle_rad = 0.0;   // output
  double initial_rest_s = 60.0;     // how long it has stood there
  bool rotor_locked = false;        // T: the SEA experiment locks the rotor mechanically
  double spread = 0.0;  // this rig's parameters differ by up to this share (from the seed)
  std::uint64_t seed = 1;
};

// The pneumatic torque as a straight line: P (slope - stiffness q), fitted to the displacement
// table within 1 rad.
struct PneumaticLine {
  double slope_Nm_bar = 0.0;
  double stiffness_Nm_rad_bar = 0.0;
};
PneumaticLine LinePneumatics(const RigParameters& parameters);

// The same rig with efficiency, inertias, frictions, gravity and displacement each off by at most
// parameters.spread, drawn from the seed: another specimen.
RigParameters Specimen(const RigParameters& parameters);

}  // namespace sinew::surrogate
