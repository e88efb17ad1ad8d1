// Pressure sensor that lags, seen where the pressure itself is known: after the valve opened and
// under compression.
#include "components/model/effects/define.h"

namespace sinew::effects::gas::pressure_lag {

std::unique_ptr<Effect> Make(const JointConstants& constants) {
  EffectInfo info;
  info.name = "pressure_lag";
  info.title = "Pressure sensor that lags";
  info.formula = "+ T * (dF/dt - (P + Pa) dV/dt / V)";
  info.source = "first order of P(t - T)";
  info.balance = Balance::kGas;
  info.smallest = Smallest::kOpening;
  info.linear = {{.name = "delay",
                  .dimension = Dimension::kTime,
                  .lower = 0.0,
                  .upper = 0.5,
                  .default_value = 0.0,
                  .meaning = "the reading is this much older than its stamp"}};
  info.signature = "reading follows late whatever moves the pressure";
  info.variable = "valve_flow_rate_bar_s";
  info.confounders = {"valve_dead_time"};
  info.separating_excitation = "fast compression with the valve shut: a valve has no part in it";
  info.needs = {"valve_flow_rate_bar_s", "pressure_bar", "volume_rate_1_s"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants& c, std::span<const double>,
                       std::span<double> phi) {
                      const double shut = x.valve_open ? 0.0 : 1.0;
                      phi[0] = x.valve_flow_rate_bar_s -
                               shut * (x.pressure_bar + c.atmosphere_bar) * x.volume_rate_1_s;
                    });
}

}  // namespace sinew::effects::gas::pressure_lag
