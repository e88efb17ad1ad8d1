#include "components/model/effects/define.h"

namespace sinew::effects::direction_dependent_viscous {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Viscous friction that depends on direction";
  info.formula = "- theta * |v|, so that B+ = B + theta and B- = B - theta";
  info.source = "Janot, Gautier, Brunot (2019), model 2";
  info.linear = {Linear("asymmetry", Dimension::kViscous, {-1e4, 1e4},
                        "half the difference of the viscous coefficients up and down")};
  info.signature = "residual even in velocity, linear in speed";
  info.confounders = {"direction_dependent_quadratic_viscous", "direction_dependent_coulomb"};
  info.separating_excitation = "constant speeds, at least three in each direction";
  info.needs = {"velocity_rad_s"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x) { return -std::abs(x.velocity_rad_s); });
}

}  // namespace sinew::effects::direction_dependent_viscous
