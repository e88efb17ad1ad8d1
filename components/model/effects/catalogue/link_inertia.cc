#include "components/model/effects/define.h"

namespace sinew::effects::link_inertia {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Inertia of the link";
  info.formula = "- Jl * a";
  info.source = "rig balance";
  info.role = Role::kInertia;
  info.linear = {Linear("link_inertia", Dimension::kInertia, {0.0, 1e3},
                        "inertia of the link about the joint, without declared payload")};
  info.signature = "residual in phase with output acceleration";
  info.confounders = {"rotor_inertia", "payload"};
  info.separating_excitation = "motion inside the free play; two known payloads";
  info.needs = {"acceleration_rad_s2"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x) { return -x.acceleration_rad_s2; });
}

}  // namespace sinew::effects::link_inertia
