// One instant of one joint: the input of every effect.
//
// SI. Rotary reading: rad and Nm at the output. A linear joint reads m for rad and N for Nm
// (docs/decisions/0003). Fields that a robot does not measure stay at 0 and are never read by its
// model, because the model file names only effects whose signals the mapping provides.
#pragma once

#include "components/base/types/gravity.h"
#include "components/base/types/joint_kind.h"

namespace sinew::effects {

struct JointSample {
  double time_s = 0.0;          // clock of the recording or of the participant; events start on it
  double position_rad = 0.0;    // output
  double velocity_rad_s = 0.0;  // output
  double acceleration_rad_s2 = 0.0;        // output
  double jerk_rad_s3 = 0.0;                // output
  double snap_rad_s4 = 0.0;                // output
  double motor_position_rad = 0.0;         // motor shaft, before the gear
  double motor_velocity_rad_s = 0.0;       // motor shaft
  double motor_acceleration_rad_s2 = 0.0;  // motor shaft
  double drive_input = 0.0;                // what the drive effect turns into torque: A, or V
  double drive_rate = 0.0;                 // its derivative, per second
  double pressure_bar = 0.0;               // chamber, gauge
  double pressure_rate_bar_s = 0.0;
  double load_force_N = 0.0;       // positive presses the link down
  double payload_kg = 0.0;         // declared by the operator
  double temperature_degC = 25.0;  // motor
  bool valve_open = false;
  double rigid_torque_Nm = 0.0;  // that the arm's rigid bodies need of this joint
  // From the model and the measured motion, not measured themselves (identify/kinematic.h).
  double volume_rate_1_s = 0.0;  // of the gas: dV/dt / V (identify/gas.h)
  double valve_flow_bar = 0.0;   // what came in since the valve was opened, as pressure
  double valve_flow_rate_bar_s = 0.0;
  double tooth_torque_Nm = 0.0;  // from the motor on the link through the teeth
  double tooth_side = 0.0;       // 1: teeth surely touch driving up, -1: down, 0: not known
  // By so much the motor's map lies elsewhere than the model has it: an encoder without an absolute
  // zero comes back turned (identify::Design::SetMotorTurn).
  double motor_turn_rad = 0.0;
};

// Constants of the joint, exactly known. Given to an effect when it is made.
struct JointConstants {
  double gear_ratio = 1.0;     // motor turns per output turn
  double link_length_m = 0.0;  // joint axis to load cell and payload; 1 by definition if linear
  double gravity_m_s2 = types::kGravity_m_s2;
  double torque_constant_Nm_A = 0.0;     // motor side
  double force_constant_N_V = 0.0;       // linear drives commanded in volts
  double back_emf_V_s_rad = 0.0;         // motor side; drives whose voltage lies on the winding
  double gas_volume_m3 = 0.0;            // chamber and all it is joined to; 0: not stated
  double atmosphere_bar = 1.01325;       // absolute
  double valve_delay_s = 0.0;            // from the command to the flow, from the data sheet
  double encoder_counts_per_turn = 0.0;  // of the coarser encoder at the output; 0: not stated
  // A linear joint has no lever (link_length_m is 1, a force counts as it is) and its position is
  // no angle to the vertical.
  types::JointKind kind = types::JointKind::kRevolute;
  // The model's pneumatic element, K P - k1 P (q - q0) (actuator::RemakeEffects); 0 without.
  double pneumatic_torque_Nm_bar = 0.0;         // K
  double pneumatic_stiffness_Nm_rad_bar = 0.0;  // k1
  double pneumatic_rest_rad = 0.0;              // q0
  // Part of the drive that the model's dry and viscous friction take before a load does, as torque
  // of an ideal drive (actuator::RemakeEffects); 0 without.
  double drive_coulomb_Nm = 0.0;
  double drive_viscous_Nm_s_rad = 0.0;
};

// Derivative of the pneumatic element's torque by the pressure at an output position, Nm/bar.
inline double TorquePerBar(const JointConstants& constants, double position_rad) noexcept {
  return constants.pneumatic_torque_Nm_bar -
         constants.pneumatic_stiffness_Nm_rad_bar * (position_rad - constants.pneumatic_rest_rad);
}

// Torque at the output of an ideal drive with the drive input 1: N Kt of a current drive (Nm/A),
// the force constant of a voltage drive (N/V), 1 where neither is known.
inline double IdealDriveGain(const JointConstants& constants) noexcept {
  if (constants.torque_constant_Nm_A > 0.0) {
    return constants.gear_ratio * constants.torque_constant_Nm_A;
  }
  return constants.force_constant_N_V > 0.0 ? constants.force_constant_N_V : 1.0;
}

}  // namespace sinew::effects
