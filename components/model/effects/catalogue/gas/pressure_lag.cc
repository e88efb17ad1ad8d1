// Pressure sensor that lags, seen where the pressure itself is known: after the valve opened and
// under compression.
#include "components/model/effects/define.h"

namespace sinew::effects::gas::pressure_lag {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Pressure sensor that lags";
  info.formula = "+ T * (dF/dt - (P + Pa) dV/dt / V)";
  info.source = "first order of P(t - T)";
  info.smallest = Smallest::kOpening;
  info.linear = {Linear("delay", Dimension::kTime, {0.0, 0.5},
                        "the reading is this much older than its stamp")};
  info.signature = "reading follows late whatever moves the pressure";
  info.confounders = {"valve_dead_time"};
  info.separating_excitation = "fast compression with the valve shut: a valve has no part in it";
  info.needs = {"valve_flow_rate_bar_s", "pressure_bar", "volume_rate_1_s"};
  return Memoryless(constants, std::move(info), [](const JointSample& x, const JointConstants& c) {
    const double shut = x.valve_open ? 0.0 : 1.0;
    return x.valve_flow_rate_bar_s - shut * (x.pressure_bar + c.atmosphere_bar) * x.volume_rate_1_s;
  });
}

}  // namespace sinew::effects::gas::pressure_lag
