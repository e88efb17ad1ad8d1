// One joint of the lab's rig: motor, gear with play, link, pneumatic element, air, sensors.
//
// Rotor angle m, output angle q (0 = link horizontal, positive up), N the ratio:
//
//     Jr dw/dt = share Kt iq - Br w - friction_r - T_tooth / N + undeclared_r
//
//     Jl dv/dt = T_tooth - friction_l - Bl v - (Tg + m g l) cos q + (p - p_atm) dV/dq - F l
//                + undeclared_l
//
//     T_tooth  = k (x -+ play/2) + c dx/dt while |x| > play/2, x = m/N - q; never pulls
//
// share: of the air-gap torque that reaches the teeth, by direction of power (parameters.h).
// Integration: drift-kick-drift (second order, symplectic for the conservative part) at 24 kHz,
// friction and air inside the step. Truth is for tests, scoring and pictures; readings are what the
// lab sees. One owner; Advance and Read are noexcept and free of allocation.
#pragma once

#include "sim/surrogate/parameters.h"
#include "sim/surrogate/random.h"

namespace sinew::surrogate {

struct RigInput {
  DriveCommand drive;
  bool valve_open = false;
  bool compressor_on = false;
  bool vent_open = false;
  double hand_force_N = 0.0;      // positive presses the link down
  double extra_payload_kg = 0.0;  // put on during the run
  // The chamber's gauge pressure, at wall temperature, whatever relays and gas would make of it.
  bool pressure_imposed = false;
  double imposed_pressure_bar = 0.0;
};

// A row of the lab's log.
struct RigReading {
  double motor_angle_rad = 0.0;       // motor shaft
  double motor_velocity_rad_s = 0.0;  // motor shaft, drive's observer
  double output_angle_rad = 0.0;
  double output_velocity_rad_s = 0.0;  // observer
  double motor_current_A = 0.0;
  double output_torque_Nm = 0.0;  // computed from the current: efficiency * N * Kt * Iq
  double drive_voltage_V = 0.0;   // q axis
  double motor_temperature_degC = 0.0;
  double chamber_pressure_bar = 0.0;
  double reservoir_pressure_bar = 0.0;
  double load_force_N = 0.0;
  double declared_payload_kg = 0.0;
  bool valve_open = false;  // as commanded to the relay
};

// The true state of the rig.
struct RigTruth {
  double time_s = 0.0;
  double motor_angle_rad = 0.0;
  double motor_velocity_rad_s = 0.0;
  double output_angle_rad = 0.0;
  double output_velocity_rad_s = 0.0;
  double iq_A = 0.0;
  double tooth_torque_Nm = 0.0;     // on the output
  int contact = 0;                  // +1 motor pushes the link up, -1 down, 0 inside the play
  double play_rad = 0.0;            // with what wear added to it
  double friction_torque_Nm = 0.0;  // on the output
  double yield_torque_Nm = 0.0;     // output friction that would have to be overcome now
  double pneumatic_torque_Nm = 0.0;
  double chamber_pressure_bar = 0.0;  // gauge
  double reservoir_pressure_bar = 0.0;
  double chamber_volume_m3 = 0.0;
  double chamber_mass_kg = 0.0;
  double payload_kg = 0.0;  // declared, put on and undeclared
};

// Mechanical and gas energy, J; for tests.
struct RigEnergy {
  double kinetic_J = 0.0;
  double gravity_J = 0.0;
  double contact_J = 0.0;  // teeth and end stops
  double springs_J = 0.0;  // friction elements
  double gas_J = 0.0;      // internal energy of the chamber plus work on the atmosphere
  double total_J() const { return kinetic_J + gravity_J + contact_J + springs_J + gas_J; }
};

class Rig {
 public:
  explicit Rig(const RigParameters& parameters);  // throws std::invalid_argument

  void Reset();
  // Starts from a given motion (tests, trials that begin somewhere else). Friction springs relaxed.
  void SetState(double motor_angle_rad, double motor_velocity_rad_s, double output_angle_rad,
                double output_velocity_rad_s) noexcept;
  // Puts the given gauge pressure, at wall temperature, into chamber and reservoir.
  void SetPressure(double chamber_bar, double reservoir_bar) noexcept;
  void SetRest(double rest_s) noexcept;
  // Bearings run dry, grease goes: from now on the output's dry friction and the rotor's viscous
  // one are these shares of the specimen's own. Not below 0. Reset takes it back.
  void Wear(double dry_share, double viscous_share) noexcept;

  // Holds the input for the given time. Non-finite or absurd inputs must not come here: see
  // Surrogate.
  void Advance(const RigInput& input, double duration_s) noexcept;
  // Reads every sensor now; draws its noise.
  RigReading Read() noexcept;

  RigTruth truth() const noexcept;
  RigEnergy Energy() const noexcept;
  const RigParameters& parameters() const noexcept { return parameters_; }  // of this specimen
  double time_s() const noexcept { return time_s_; }

 private:
  void Substep(const RigInput& input, double dt_s) noexcept;
  double Displacement_m3_rad(double angle_rad) const noexcept;
  double ChamberVolume_m3(double angle_rad) const noexcept;
  double Play_rad() const noexcept;
  double Count_rad(double angle_rad) const noexcept;  // as an encoder reads it
  double StepDrive_Nm(const DriveCommand& command, double dt_s) noexcept;
  void Drift(double duration_s) noexcept;
  void MoveAir(const RigInput& input, double dt_s) noexcept;
  void SetTorques(double dt_s) noexcept;
  double Tooth_Nm() const noexcept;
  void KickOutput(double dt_s) noexcept;
  void KickRotor(double air_gap_Nm, double dt_s) noexcept;

  RigParameters parameters_;
  Motor motor_;
  Drive drive_;
  SlipBank rotor_friction_;
  SlipBank output_friction_;
  Undeclared undeclared_;
  Vessel chamber_;
  Vessel reservoir_;
  Relay valve_relay_;
  Relay compressor_relay_;
  Relay vent_relay_;
  TrackingObserver output_observer_;
  RandomStream motor_encoder_noise_{0, 0};
  RandomStream output_encoder_noise_{0, 0};
  RandomStream row_noise_motor_{0, 0};
  RandomStream row_noise_output_{0, 0};
  RandomStream current_noise_{0, 0};
  RandomStream pressure_noise_{0, 0};
  RandomStream reservoir_noise_{0, 0};
  RandomStream load_cell_noise_{0, 0};
  RandomStream temperature_noise_{0, 0};
  std::vector<double> volume_table_m3_;
  double table_step_rad_ = 0.0;
  double sensor_step_s_ = 0.0;
  double count_rad_ = 0.0;

  double dry_share_ = 1.0;
  double viscous_share_ = 1.0;
  double time_s_ = 0.0;
  double motor_rad_ = 0.0;
  double motor_rad_s_ = 0.0;
  double output_rad_ = 0.0;
  double output_rad_s_ = 0.0;
  double until_sensor_s_ = 0.0;
  double torque_reference_Nm_ = 0.0;
  double tooth_Nm_ = 0.0;
  double friction_Nm_ = 0.0;
  double pneumatic_Nm_ = 0.0;
  double undeclared_output_Nm_ = 0.0;
  double undeclared_rotor_Nm_ = 0.0;
  double hand_force_N_ = 0.0;
  double payload_kg_ = 0.0;
  bool valve_command_ = false;
  // States of undeclared effects only.
  double tip_rad_ = 0.0;  // flexible link: its outer part
  double tip_rad_s_ = 0.0;
  double lagged_gauge_Pa_ = 0.0;  // in a lagging pressure sensor
  struct Past {
    double time_s = 0.0;
    double motor_rad = 0.0;
    double output_rad = 0.0;
    double motor_estimate_rad_s = 0.0;
    double output_estimate_rad_s = 0.0;
  };
  Past Now() const noexcept;
  Past Seen() const noexcept;  // what the encoders' telegrams report now
  std::vector<Past> past_;     // ring; empty: telegrams are not late
  std::size_t past_next_ = 0;
};

}  // namespace sinew::surrogate
