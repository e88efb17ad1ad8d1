// The declared gas: valve shut, constant mass, isothermal.
#include "components/model/effects/define.h"

namespace sinew::effects::gas::gas_compression {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Isothermal compression";
  info.formula = "+ s * integral of (P + Pa) dV/dt / V, s = stated volume / volume";
  info.source = "Boyle: d/dt[(P + Pa) V] = 0; dV/dq = pneumatic torque per pressure (virtual work)";
  info.rate = true;
  info.linear = {Linear("share", Dimension::kNone, {0.0, 10.0},
                        "gas_volume_m3 divided by the volume: 1.1 is a tenth less volume", 1.0)};
  info.signature = "pressure follows the angle";
  info.variable = "position_rad";
  info.confounders = {"pressure_offset", "gas_heat_exchange"};
  info.separating_excitation = "slow and fast motion at several pressures, valve shut";
  info.needs = {"pressure_bar", "volume_rate_1_s"};
  return Memoryless(constants, std::move(info), [](const JointSample& x, const JointConstants& c) {
    const double shut = x.valve_open ? 0.0 : 1.0;
    return shut * (x.pressure_bar + c.atmosphere_bar) * x.volume_rate_1_s;
  });
}

}  // namespace sinew::effects::gas::gas_compression
