// Inertia of the link.
#include "components/model/effects/define.h"

namespace sinew::effects::link_inertia {

std::unique_ptr<Effect> Make(const JointConstants& constants) {
  EffectInfo info;
  info.name = "link_inertia";
  info.title = "Inertia of the link";
  info.formula = "- Jl * a";
  info.source = "rig balance";
  info.role = Role::kInertia;
  info.linear = {{.name = "link_inertia",
                  .dimension = Dimension::kInertia,
                  .lower = 0.0,
                  .upper = 1e3,
                  .default_value = 0.0,
                  .meaning = "inertia of the link about the joint, without declared payload"}};
  info.signature = "residual in phase with output acceleration";
  info.variable = "acceleration_rad_s2";
  info.confounders = {"rotor_inertia", "payload"};
  info.separating_excitation = "motion inside the free play; two known payloads";
  info.needs = {"acceleration_rad_s2"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants&, std::span<const double>,
                       std::span<double> phi) { phi[0] = -x.acceleration_rad_s2; });
}

}  // namespace sinew::effects::link_inertia
