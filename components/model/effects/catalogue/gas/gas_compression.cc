// The declared gas: valve shut, constant mass, isothermal.
#include "components/model/effects/define.h"

namespace sinew::effects::gas::gas_compression {

std::unique_ptr<Effect> Make(const JointConstants& constants) {
  EffectInfo info;
  info.name = "gas_compression";
  info.title = "Isothermal compression";
  info.formula = "+ s * integral of (P + Pa) dV/dt / V, s = stated volume / volume";
  info.source = "Boyle: d/dt[(P + Pa) V] = 0; dV/dq = pneumatic torque per pressure (virtual work)";
  info.balance = Balance::kGas;
  info.rate = true;
  info.linear = {{.name = "share",
                  .dimension = Dimension::kNone,
                  .lower = 0.0,
                  .upper = 10.0,
                  .default_value = 1.0,
                  .meaning = "gas_volume_m3 divided by the volume: 1.1 is a tenth less volume"}};
  info.signature = "pressure follows the angle";
  info.variable = "position_rad";
  info.confounders = {"pressure_offset", "gas_heat_exchange"};
  info.separating_excitation = "slow and fast motion at several pressures, valve shut";
  info.needs = {"pressure_bar", "volume_rate_1_s"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants& c, std::span<const double>,
                       std::span<double> phi) {
                      const double shut = x.valve_open ? 0.0 : 1.0;
                      phi[0] = shut * (x.pressure_bar + c.atmosphere_bar) * x.volume_rate_1_s;
                    });
}

}  // namespace sinew::effects::gas::gas_compression
