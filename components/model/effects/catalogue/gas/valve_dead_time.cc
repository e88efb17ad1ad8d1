// Valve whose flow begins later than command and data sheet say.
#include "components/model/effects/define.h"

namespace sinew::effects::gas::valve_dead_time {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Dead time of the valve";
  info.formula = "+ T * dF/dt (t - t_open)";
  info.source = "first order of F(t - T); dead times of solenoid valves: ISO 12238";
  info.smallest = Smallest::kOpening;
  info.linear = {Linear("dead_time", Dimension::kTime, {0.0, 0.5},
                        "from the command to the flow, beyond valve_delay_s")};
  info.signature = "after the command to open the pressure stands still for a while";
  info.confounders = {"pressure_lag"};
  info.separating_excitation =
      "pressure steps with a fast logger: a dead time shifts, a lag rounds";
  info.needs = {"valve_flow_rate_bar_s"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x) { return x.valve_flow_rate_bar_s; });
}

}  // namespace sinew::effects::gas::valve_dead_time
