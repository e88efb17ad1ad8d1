// Air that leaves the shut chamber.
#include "components/model/effects/define.h"

namespace sinew::effects::gas::leak {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Leak";
  info.formula = "+ c * integral of Pa * (((P + Pa)^2 - Pa^2) / Pa^2)^n";
  info.source =
      "n = 1: laminar gap (Blackburn, Reethof, Shearer: Fluid Power Control (1960), ch. 3); n = "
      "1/2: "
      "orifice, ISO 6358-1 with critical ratio 0";
  info.rate = true;
  info.linear = {Linear("rate", Dimension::kRate, {0.0, 10.0},
                        "pressure lost per second, in atmospheres, where P + Pa = 1.41 Pa")};
  info.nonlinear = {Nonlinear("exponent", Dimension::kNone, {0.5, 1.0}, 0.5, {0.5, 0.75, 1.0},
                              "1: laminar, 1/2: orifice")};
  info.signature = "pressure falls while the valve is shut, faster at high pressure";
  info.confounders = {"gas_heat_exchange"};
  info.separating_excitation =
      "minutes with the valve shut at several pressures: heat is exchanged "
      "within seconds, a leak goes on";
  info.needs = {"pressure_bar"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants& c, std::span<const double> psi) {
                      const double ratio = 1.0 + x.pressure_bar / c.atmosphere_bar;
                      const double over = ratio * ratio - 1.0;
                      return (x.valve_open ? 0.0 : 1.0) * c.atmosphere_bar * Sign(over) *
                             std::pow(std::abs(over), psi[0]);
                    });
}

}  // namespace sinew::effects::gas::leak
