// A small rig for controller tests, written apart from the project's effects and plants: rotor and
// link joined by elastic teeth with play, gear friction, gravity and the torque of a chamber at
// constant pressure. Explicit steps of 1/24000 s; the encoder of the output has 14 bit.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sinew::control {

struct TestRig {
  double gear_ratio = 100.0;
  double efficiency = 0.77;
  double rotor_inertia_kg_m2 = 0.12;  // at the output
  double link_inertia_kg_m2 = 0.02;
  double viscous_Nm_s_rad = 0.3;  // on motor velocity / N
  double coulomb_Nm = 0.22;       // on output velocity
  double gravity_Nm = 0.58;
  double pneumatic_Nm = 0.3587 * 4.0;
  double play_rad = 0.0464258;
  double tooth_Nm_rad = 3000.0;
  double tooth_Nm_s_rad = 2.0;
  double extra_viscous_up_Nm_s_rad = 0.0;  // an undeclared effect: only on the way up

  double motor_rad = 0.0;  // motor angle / N
  double motor_rad_s = 0.0;
  double link_rad = 0.0;
  double link_rad_s = 0.0;

  void Step(double motor_torque_Nm, double period_s) {
    constexpr double kStep_s = 1.0 / 24000.0;
    const int steps = static_cast<int>(std::lround(period_s / kStep_s));
    for (int i = 0; i < steps; ++i) {
      const double gap = motor_rad - link_rad;
      double tooth_Nm = 0.0;
      const double over = std::abs(gap) - 0.5 * play_rad;
      if (over > 0.0) {
        const double side = gap > 0.0 ? 1.0 : -1.0;
        tooth_Nm = side * std::max(0.0, tooth_Nm_rad * over +
                                            tooth_Nm_s_rad * side * (motor_rad_s - link_rad_s));
      }
      const double drive_Nm = motor_torque_Nm * gear_ratio * efficiency;
      const double up_Nm = link_rad_s > 0.0 ? extra_viscous_up_Nm_s_rad * link_rad_s : 0.0;
      const double friction_Nm = coulomb_Nm * std::tanh(link_rad_s / 2e-3) + up_Nm;
      motor_rad_s +=
          kStep_s * (drive_Nm - viscous_Nm_s_rad * motor_rad_s - tooth_Nm) / rotor_inertia_kg_m2;
      link_rad_s += kStep_s *
                    (tooth_Nm + pneumatic_Nm - gravity_Nm * std::cos(link_rad) - friction_Nm) /
                    link_inertia_kg_m2;
      motor_rad += kStep_s * motor_rad_s;
      link_rad += kStep_s * link_rad_s;
    }
  }

  double encoder_rad() const {
    constexpr double kCount = 2.0 * std::numbers::pi / 16384.0;
    return kCount * std::round(link_rad / kCount);
  }
};

}  // namespace sinew::control
