// Effects of a joint model's gas terms on an isothermal chamber: leaks, heat, a valve that opens
// late.
//
// The terms of the gas balance that are rates (effects::EffectInfo::rate), but for the declared
// compression, which the chamber plays itself:
//
//     dP/dt = ... - sum of theta phi        bar/s, valve shut
//
// Sensors that lag or are off act on the reading, not on the gas, and are left out. Thread: one.
// Steps allocate nothing.
#pragma once

#include <vector>

#include "components/model/actuator/model.h"

namespace sinew::plant {

class GasEffects {
 public:
  explicit GasEffects(const actuator::JointModel& model);

  void Reset();
  // The valve as it is, dead time passed: opens that much after the command and shuts at once.
  bool Valve(bool command, double dt_s) noexcept;
  // Added to the pressure's rate, bar/s, in a step that ends with this state.
  // volume_rate_1_s: dV/dt / V.
  double Rate_bar_s(double pressure_bar, double pressure_rate_bar_s, double volume_rate_1_s,
                    bool valve_open, double dt_s) noexcept;

 private:
  actuator::JointModel model_;  // the terms that act, and no others
  std::vector<double> memory_;
  double dead_time_s_ = 0.0, waited_s_ = 0.0;
};

}  // namespace sinew::plant
