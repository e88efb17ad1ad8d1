// Inertia of the rotor on its own acceleration: with free play it differs from the link's.
#include "components/model/effects/define.h"

namespace sinew::effects::rotor_inertia {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Inertia of rotor and gear";
  info.formula = "- Jm * a_motor / N";
  info.source = "thesis (4.21)-(4.26), rig balance";
  info.role = Role::kInertia;
  info.side = Side::kMotor;
  info.linear = {Linear("rotor_inertia", Dimension::kInertia, {0.0, 1e3},
                        "inertia of the rotor seen at the output, N^2 times its own")};
  info.signature = "residual in phase with motor acceleration";
  info.confounders = {"link_inertia", "payload"};
  info.separating_excitation = "motion inside the free play, where only the rotor accelerates";
  info.needs = {"motor_acceleration_rad_s2"};
  return Memoryless(constants, std::move(info), [](const JointSample& x, const JointConstants& c) {
    return -x.motor_acceleration_rad_s2 / c.gear_ratio;
  });
}

}  // namespace sinew::effects::rotor_inertia
