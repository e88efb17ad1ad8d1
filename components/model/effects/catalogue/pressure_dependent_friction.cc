#include "components/model/effects/define.h"

namespace sinew::effects::pressure_dependent_friction {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Seal friction that grows with pressure";
  info.formula = "- c * P * sign v";
  info.source = "Nouri et al.: Modelling a pneumatic servo positioning system with friction (2000)";
  info.linear = {
      Linear("friction", Dimension::kTorquePerBar, {0.0, 1e3}, "friction per gauge pressure")};
  info.signature = "Coulomb step that grows with pressure";
  info.confounders = {"seal_hysteresis", "coulomb"};
  info.separating_excitation =
      "reversals at several pressures: hysteresis turns over an angle, friction at once";
  info.needs = {"pressure_bar", "velocity_rad_s"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x) { return -x.pressure_bar * Sign(x.velocity_rad_s); });
}

}  // namespace sinew::effects::pressure_dependent_friction
