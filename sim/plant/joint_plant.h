// One SEA-PEA actuator by its joint model: drive, rotor, free play, and every term of the
// model.
//
// Two bodies where the model has free play: the rotor (motor angle / N) with the terms of
// Side::kMotor and the link with those of Side::kOutput, coupled by the teeth
//
//     T_tooth = max(0, k d + c dd/dt),   d = (motor/N - output) - play/2   (and mirrored)
//
// One body without free play. The link itself is integrated by the caller (Bullet, or SingleJoint):
// the plant gives the torque, added inertia and friction on it. A step is drift - kick -
// drift: half a step of motion, forces there, the velocities, the other half; second order and
// symmetric, so that the energy of a frictionless joint does not drift.
//
// Friction is found from the terms, whatever they are called: the part of the velocity-dependent
// torque that is odd in velocity and opposes it. It is handed out as a bound (friction.h), so that
// joints stick. Terms in jerk and snap see accelerations through a first-order filter (1 ms or what
// stability needs), terms in the drive's rate a drive input that lags by the model's transport
// delay, which makes it a lag of exactly that time.
//
// Position and velocity mode are the motor controller's cascade: position gain -> velocity,
// velocity gain and integrator -> torque, at the motor, each step.
//
// Of the kinematic terms, backlash_width widens the play, compliance (of the teeth or added) makes
// the teeth softer, and encoder_eccentricity is what the output's encoder reads too much
// (encoder_error_rad).
//
// Units: SI, a linear joint reads m for rad and N for Nm. Thread: one. Steps allocate nothing.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "components/base/types/control_mode.h"
#include "components/model/actuator/model.h"

namespace sinew::plant {

struct DriveCommand {
  types::ControlMode mode = types::ControlMode::kIdle;
  double motor_torque_Nm = 0.0;  // at the motor shaft, positive drives the output up
  double position_rad = 0.0;     // output
  double velocity_rad_s = 0.0;   // output; feed-forward in position mode
};

struct JointPlantConfig {
  double contact_stiffness_Nm_rad =
      2.0e4;  // of the teeth, at the output; lowered where a step needs it
  double contact_damping_ratio = 0.3;
  double position_gain_1_s = 30.0;
  double velocity_bandwidth_rad_s = 300.0;  // velocity gain = this x inertia
  double velocity_integral_1_s = 30.0;      // integrator gain / velocity gain
  double motor_temperature_degC = 25.0;
  // The link's inertia and gravity are in the caller's body: leave out the model's link inertia
  // terms.
  bool link_inertia_in_body = false;
};

// The load on the link during a step.
struct LinkLoad {
  double torque_Nm = 0.0;  // without friction
  double added_inertia_kg_m2 = 0.0;
  double friction_Nm = 0.0;  // bound of a torque that opposes motion
};

class JointPlant {
 public:
  // Throws std::invalid_argument: free play without rotor inertia, or a configuration that cannot
  // be.
  JointPlant(const actuator::JointModel& model, const JointPlantConfig& config);

  // Output at rest at this angle, teeth in the middle of the play. body_inertia: of the caller's
  // body as seen at the joint (0: the model describes it all).
  void Reset(double position_rad, double body_inertia_kg_m2);

  // Sets the rotor's state after Reset; without free play the rotor is where the output is.
  void SetRotor(double motor_position_rad, double motor_velocity_rad_s) noexcept;

  void SetCommand(const DriveCommand& command) noexcept;
  // hand_force: presses the link down. declared + extra payload hang at the load cell.
  void SetLoad(double hand_force_N, double payload_kg) noexcept;
  void SetPressure(double pressure_bar, double rate_bar_s) noexcept;
  void SetMotorTemperature(double temperature_degC) noexcept;
  // Everything around the joint as in a recording: time, pressure, load force, payload,
  // temperature and valve of x; the rest of x is not read. A payload or load force for which the
  // model has no term is left out, as in its balance.
  void SetSurroundings(const effects::JointSample& x) noexcept;
  // Memory of the terms, as of actuator::JointModel (same size and order).
  void SetMemory(std::span<const double> memory) noexcept;

  // First half of a step: the output is at `position_rad` (half a step on) with the velocity of its
  // start.
  LinkLoad Begin(double position_rad, double velocity_rad_s, double dt_s) noexcept;
  // Second half: the output's velocity and angle at the end of the step.
  void End(double position_rad, double velocity_rad_s, double dt_s) noexcept;

  double motor_position_rad() const noexcept;  // at the shaft
  double motor_velocity_rad_s() const noexcept;
  double drive_input() const { return sample_.drive_input; }  // A or V
  double drive_torque_Nm() const noexcept;                    // at the output, by the drive terms
  double tooth_torque_Nm() const { return tooth_torque_Nm_; }
  // Output encoder's reading minus the angle, by the model's kinematic terms.
  double encoder_error_rad() const noexcept;
  double motor_temperature_degC() const { return sample_.temperature_degC; }
  // Kinetic energy of the rotor and elastic energy of the teeth.
  double stored_energy_J() const noexcept;
  bool has_play() const { return play_rad_ > 0.0; }
  double play_rad() const { return play_rad_; }
  const actuator::JointModel& model() const { return model_; }
  // Inertia of the model's link terms (Role::kInertia on the output side), at zero payload.
  static double LinkInertia(const actuator::JointModel& model);

 private:
  struct CompiledTerm {
    const effects::Effect* effect = nullptr;
    std::array<double, effects::kMaxParameters> theta{}, psi{};
    std::size_t linear = 0, nonlinear = 0, memory_at = 0, memory_size = 0;
  };
  // Terms of one body, by what they read.
  struct Body {
    std::vector<CompiledTerm> steady, velocity, acceleration, jerk, snap;
  };
  struct Forces {
    double torque = 0.0;  // even part and anything that drives
    double friction = 0.0;
    double inertia = 0.0;
  };

  double Evaluate(const CompiledTerm& term, const effects::JointSample& x) const noexcept;
  double Sum(const std::vector<CompiledTerm>& terms, const effects::JointSample& x) const noexcept;
  // Forces on a body that moves with a velocity; reversing it reverses the named sample velocities.
  Forces ForcesOn(const Body& body, double velocity, bool reverses_output,
                  bool reverses_motor) noexcept;
  void UpdateDrive(double dt_s) noexcept;
  // The link as given; a rotor with play drifts by half of the step, any other one follows.
  void MoveTo(double position_rad, double velocity_rad_s, double dt_s) noexcept;

  actuator::JointModel model_;
  JointPlantConfig config_;
  double gear_ratio_ = 1.0, play_rad_ = 0.0;
  double ideal_drive_gain_ = 1.0;  // torque at the output per drive input
  Body motor_, output_;
  std::vector<CompiledTerm> drive_;
  std::vector<CompiledTerm> encoder_;
  std::vector<CompiledTerm> with_memory_;
  std::vector<double> memory_;
  effects::JointSample sample_;
  DriveCommand command_;
  bool adds_payload_ = false, adds_load_force_ = false;           // the model has no such terms
  double rotor_position_rad_ = 0.0, rotor_velocity_rad_s_ = 0.0;  // motor / N
  double rotor_inertia_kg_m2_ = 0.0, controlled_inertia_kg_m2_ = 0.0, body_inertia_kg_m2_ = 0.0;
  double tooth_torque_Nm_ = 0.0, contact_stiffness_Nm_rad_ = 0.0;
  double stiffest_contact_Nm_rad_ = 0.0;
  double integrator_Nm_ = 0.0;
  double lagged_drive_ = 0.0, drive_lag_s_ = 0.0;
  double motion_filter_s_ = 1e-3;
  double filtered_acceleration_ = 0.0, filtered_jerk_ = 0.0;
  double last_velocity_ = 0.0;
};

}  // namespace sinew::plant
