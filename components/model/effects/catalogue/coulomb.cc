#include "components/model/effects/define.h"

namespace sinew::effects::coulomb {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Coulomb friction";
  info.formula = "- Fc * sign v, 0 at v = 0";
  info.source = "Coulomb; thesis (5.4)";
  info.linear = {Linear("coulomb", Dimension::kTorque, {0.0, 1e3}, "friction torque while moving")};
  info.signature = "residual steps where velocity changes sign";
  info.confounders = {"stribeck", "load_dependent_friction", "direction_dependent_coulomb"};
  info.separating_excitation = "slow motion in both directions at two loads";
  info.needs = {"velocity_rad_s"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x) { return -Sign(x.velocity_rad_s); });
}

}  // namespace sinew::effects::coulomb
