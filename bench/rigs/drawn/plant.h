// The physics of a rig: motor, coupling, link, gas and servo, with what is undeclared.
//
// Written apart from everything that is fitted to it. Two bodies (one where the coupling is rigid),
// semi-implicit steps of at most 0.125 ms. Friction is an elasto-plastic bristle (Dupont et al.
// 2002): below 0.7 of the level purely elastic, so that a joint at rest stays there. Teeth are a
// one-sided spring and damper.
#pragma once

#include <vector>

#include "bench/rigs/drawn/motion.h"
#include "bench/rigs/drawn/rig.h"
#include "bench/rigs/drawn/undeclared.h"

namespace sinew::rigs {

// What sensors without noise would read, and truths that no sensor reads, at one row.
struct TrueRow {
  double time_s = 0.0;
  double motor = 0.0;                           // motor angle / gear ratio
  double position = 0.0;                        // as the output's encoder reads it
  double motor_velocity = 0.0, velocity = 0.0;  // true, at the output
  double drive = 0.0;                           // A, V or unit of force, by Rig::drive
  double supply_V = 0.0;
  double pressure_bar = 0.0;  // as the sensor reads it
  double load_force_N = 0.0;
  bool valve_open = false;
  double payload_kg = 0.0;  // declared
  double temperature_degC = 25.0;
  double reference = 0.0;
  // Truth.
  double true_position = 0.0;
  double tooth_force = 0.0;
  double true_drive_force = 0.0;
  double true_pressure_bar = 0.0;
};

// One recording. Throws std::invalid_argument for an effect that is not in the list.
std::vector<TrueRow> Simulate(const Rig& rig, const std::vector<Effect>& effects,
                              const Motion& motion);

}  // namespace sinew::rigs
