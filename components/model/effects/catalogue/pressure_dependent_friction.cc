// Seal friction that grows with pressure.
#include "components/model/effects/define.h"

namespace sinew::effects::pressure_dependent_friction {

std::unique_ptr<Effect> Make(const JointConstants& constants) {
  EffectInfo info;
  info.name = "pressure_dependent_friction";
  info.title = "Seal friction that grows with pressure";
  info.formula = "- c * P * sign v";
  info.source = "Nouri et al.: Modelling a pneumatic servo positioning system with friction (2000)";
  info.linear = {{.name = "friction",
                  .dimension = Dimension::kTorquePerBar,
                  .lower = 0.0,
                  .upper = 1e3,
                  .default_value = 0.0,
                  .meaning = "friction per gauge pressure"}};
  info.signature = "Coulomb step that grows with pressure";
  info.variable = "pressure_bar";
  info.confounders = {"seal_hysteresis", "coulomb"};
  info.separating_excitation =
      "reversals at several pressures: hysteresis turns over an angle, friction at once";
  info.needs = {"pressure_bar", "velocity_rad_s"};
  return Memoryless(
      constants, std::move(info),
      [](const JointSample& x, const JointConstants&, std::span<const double>,
         std::span<double> phi) { phi[0] = -x.pressure_bar * Sign(x.velocity_rad_s); });
}

}  // namespace sinew::effects::pressure_dependent_friction
