#include "components/model/effects/define.h"

namespace sinew::effects::direction_dependent_coulomb {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Coulomb friction that depends on direction";
  info.formula = "- theta while moving, 0 at v = 0";
  info.source = "Janot, Gautier, Brunot (2019), model 2";
  info.linear = {Linear("asymmetry", Dimension::kTorque, {-1e3, 1e3},
                        "half the difference of the Coulomb torques up and down")};
  info.signature = "while moving, a constant: it cannot be distinguished from an offset";
  info.confounders = {"offset", "current_offset", "direction_dependent_viscous"};
  info.separating_excitation = "torque at rest, approached from both sides";
  info.needs = {"velocity_rad_s"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x) { return -std::abs(Sign(x.velocity_rad_s)); });
}

}  // namespace sinew::effects::direction_dependent_coulomb
