// Valve whose flow begins later than command and data sheet say.
#include "components/model/effects/define.h"

namespace sinew::effects::gas::valve_dead_time {

std::unique_ptr<Effect> Make(const JointConstants& constants) {
  EffectInfo info;
  info.name = "valve_dead_time";
  info.title = "Dead time of the valve";
  info.formula = "+ T * dF/dt (t - t_open)";
  info.source = "first order of F(t - T); dead times of solenoid valves: ISO 12238";
  info.balance = Balance::kGas;
  info.smallest = Smallest::kOpening;
  info.linear = {{.name = "dead_time",
                  .dimension = Dimension::kTime,
                  .lower = 0.0,
                  .upper = 0.5,
                  .default_value = 0.0,
                  .meaning = "from the command to the flow, beyond valve_delay_s"}};
  info.signature = "after the command to open the pressure stands still for a while";
  info.variable = "valve_flow_rate_bar_s";
  info.confounders = {"pressure_lag"};
  info.separating_excitation =
      "pressure steps with a fast logger: a dead time shifts, a lag rounds";
  info.needs = {"valve_flow_rate_bar_s"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants&, std::span<const double>,
                       std::span<double> phi) { phi[0] = x.valve_flow_rate_bar_s; });
}

}  // namespace sinew::effects::gas::valve_dead_time
