// Coulomb friction.
#include "components/model/effects/define.h"

namespace sinew::effects::coulomb {

std::unique_ptr<Effect> Make(const JointConstants& constants) {
  EffectInfo info;
  info.name = "coulomb";
  info.title = "Coulomb friction";
  info.formula = "- Fc * sign v, 0 at v = 0";
  info.source = "Coulomb; thesis (5.4)";
  info.linear = {{.name = "coulomb",
                  .dimension = Dimension::kTorque,
                  .lower = 0.0,
                  .upper = 1e3,
                  .default_value = 0.0,
                  .meaning = "friction torque while moving"}};
  info.signature = "residual steps where velocity changes sign";
  info.variable = "velocity_rad_s";
  info.confounders = {"stribeck", "load_dependent_friction", "direction_dependent_coulomb"};
  info.separating_excitation = "slow motion in both directions at two loads";
  info.needs = {"velocity_rad_s"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants&, std::span<const double>,
                       std::span<double> phi) { phi[0] = -Sign(x.velocity_rad_s); });
}

}  // namespace sinew::effects::coulomb
