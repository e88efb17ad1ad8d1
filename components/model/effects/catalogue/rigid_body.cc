// Torque that the rigid bodies of an arm need of this joint, computed for all joints together from
// the URDF (components/model/arm).
#include "components/model/effects/define.h"

namespace sinew::effects::rigid_body {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Rigid bodies of the arm";
  info.formula = "- share * tau(q, v, a)";
  info.source = "Khalil, Dombre: Modeling, Identification and Control of Robots (2002), 9.3";
  info.linear = {Linear("share", Dimension::kNone, {0.5, 1.5},
                        "1: as the bodies are fitted; fixed in model files", 1.0)};
  info.signature = "residual follows what gravity and inertia of the arm need";
  info.confounders = {"gravity", "inertia", "payload"};
  info.separating_excitation = "motion of all joints at once";
  info.needs = {"rigid_torque_Nm"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x) { return -x.rigid_torque_Nm; });
}

}  // namespace sinew::effects::rigid_body
