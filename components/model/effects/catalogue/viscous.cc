#include "components/model/effects/define.h"

namespace sinew::effects::viscous {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Viscous friction on the output";
  info.formula = "- B * v";
  info.source = "Khalil, Dombre: Modeling, Identification and Control of Robots (2002)";
  info.linear = {
      Linear("viscous", Dimension::kViscous, {0.0, 1e4}, "torque per velocity, at the output")};
  info.signature = "residual linear in velocity";
  info.confounders = {"motor_viscous", "quadratic_viscous", "stribeck"};
  info.separating_excitation = "constant speeds, several, both directions";
  info.needs = {"velocity_rad_s"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x) { return -x.velocity_rad_s; });
}

}  // namespace sinew::effects::viscous
