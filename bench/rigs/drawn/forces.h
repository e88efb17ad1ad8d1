// Undeclared effects as numbers that the plant's step reads, and the pieces of force they make.
#pragma once

#include <array>
#include <vector>

#include "bench/rigs/drawn/motion.h"
#include "bench/rigs/drawn/rig.h"
#include "bench/rigs/drawn/undeclared.h"

namespace sinew::rigs {

// Sizes by name (0: absent) and shapes.
struct Undeclared {
  double coulomb_asymmetry = 0, viscous_asymmetry = 0, quadratic = 0, stribeck = 0,
         stribeck_speed = 1, presliding = 0, load_share = 0, backward_gain = 0, warm_share = 0,
         cogging = 0, eccentricity = 0, tooth_compliance = 0, play = 0, encoder_wave = 0,
         elastic_s = 0, flexible_share = 0, delay_s = 0, saturation = 0, drive_gain = 0,
         current_offset = 0, payload_kg = 0, step_kg = 0, bump = 0, cell_gain = 0, cell_angle = 0,
         tilt = 0, pressure_friction = 0, pressure_gain = 0, pressure_offset = 0,
         pressure_lag_s = 0, seal = 0, collapse = 0, cable = 0, tooth_defect = 0, sag = 0,
         slow_tilt = 0, slip = 0, rest_stiction = 0, impacts = 0, warm_up = 0, leak_m2 = 0,
         gas_wall_s = 0;
  std::array<double, 4> cogging_shape{}, eccentricity_shape{}, encoder_shape{}, flexible_shape{},
      seal_shape{}, collapse_shape{}, cable_shape{}, defect_shape{}, rest_shape{}, warm_shape{};
  // Instants of this recording.
  double step_start_s = 0, bump_start_s = 0, bump_length_s = 0.3;
  std::array<double, 3> slips_s{};
  std::vector<std::array<double, 2>> hits;  // start, signed share
};

Undeclared Resolve(const Rig& rig, const std::vector<Effect>& effects, const Motion& motion);

// The bristle's state zeta in [-1, 1]; `plastic` 1 everywhere: the old Dahl law, without stiction.
double StepBristle(double zeta, double velocity, double length, double step_s,
                   bool stiction) noexcept;

// Forces on the link that depend on position and time alone (cable, tooth, wheel).
double PositionForce(const Undeclared& u, double position, double amplitude) noexcept;
// Forces of an instant: push, impacts.
double EventForce(const Undeclared& u, double time_s) noexcept;
double MotorForce(const Undeclared& u, double motor_angle) noexcept;  // cogging
// Drive current as the magnet turns it into torque.
double Saturated(const Undeclared& u, double current, double limit) noexcept;

}  // namespace sinew::rigs
