// Compliant gear, seen by an encoder on either side of it.
#include "components/model/effects/define.h"

namespace sinew::effects::kinematic::gear_compliance {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Compliant gear";
  info.formula = "- c * tooth torque";
  info.source =
      "series spring: Spong, Modeling and Control of Elastic Joint Robots (1987); "
      "twist = torque / stiffness";
  info.smallest = Smallest::kRounding;
  info.linear = {Linear("compliance", Dimension::kAnglePerTorque, {0.0, 1.0},
                        "twist per torque at the output, 1 / stiffness")};
  info.signature = "difference of the encoders grows with the torque that the teeth carry";
  info.confounders = {"backlash_width"};
  info.separating_excitation = "small and large torque on either side of the play";
  info.needs = {"tooth_torque_Nm"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x) { return -x.tooth_torque_Nm; });
}

}  // namespace sinew::effects::kinematic::gear_compliance
