#include "components/model/effects/define.h"

namespace sinew::effects::inertia {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Inertia of a joint that moves as one body";
  info.formula = "- J * a";
  info.source = "Newton";
  info.role = Role::kInertia;
  info.linear = {Linear("inertia", Dimension::kInertia, {0.0, 1e4},
                        "inertia at the output, rotor included (mass of a linear joint)")};
  info.signature = "residual in phase with acceleration";
  info.confounders = {"payload", "gear_compliance"};
  info.separating_excitation = "accelerations of different size at the same angle";
  info.needs = {"acceleration_rad_s2"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x) { return -x.acceleration_rad_s2; });
}

}  // namespace sinew::effects::inertia
