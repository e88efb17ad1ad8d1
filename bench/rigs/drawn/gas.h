// Air in one chamber by mass and energy, an orifice to the regulator, a wall that takes heat.
//
//   P = m R T / V(q);  m cv dT = -P dV + h (Tw - T) + dm (cp Ts - cv T),  dm from ISO 6358 (b =
//   0.35)
#pragma once

#include "bench/rigs/drawn/rig.h"

namespace sinew::rigs {

class Gas {
 public:
  // Filled to a gauge pressure at rest; a hole to the outside, more time for the wall to take heat.
  Gas(const Rig& rig, double position, double gauge_bar, double leak_m2 = 0.0,
      double wall_time_s = 0.0);

  // Position at the end of the step; regulator's gauge pressure; whether the valve joins the two.
  void Step(double position, double regulator_bar, bool open, double step_s) noexcept;

  double gauge_bar() const { return gauge_bar_; }
  double mass_kg() const { return mass_kg_; }
  double energy_J() const;

 private:
  double Volume(double position) const;

  double slope_, stiffness_, rest_, volume_at_rest_, wall_time_s_, area_m2_, leak_m2_;
  double volume_m3_, mass_kg_, temperature_K_, gauge_bar_;
};

}  // namespace sinew::rigs
