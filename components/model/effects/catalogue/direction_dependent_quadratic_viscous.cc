#include "components/model/effects/define.h"

namespace sinew::effects::direction_dependent_quadratic_viscous {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Quadratic friction that depends on direction";
  info.formula = "- theta * v^2";
  info.source = "even part of the friction curve, second order";
  info.linear = {Linear("asymmetry", Dimension::kQuadraticViscous, {-1e5, 1e5},
                        "half the difference of the quadratic coefficients up and down")};
  info.signature = "residual even in velocity, growing with its square";
  info.confounders = {"direction_dependent_viscous"};
  info.separating_excitation = "constant speeds, at least three in each direction";
  info.needs = {"velocity_rad_s"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x) { return -x.velocity_rad_s * x.velocity_rad_s; });
}

}  // namespace sinew::effects::direction_dependent_quadratic_viscous
