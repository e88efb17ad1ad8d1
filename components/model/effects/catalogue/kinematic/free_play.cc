// The declared free play: teeth in contact stand half of its width from the middle.
#include "components/model/effects/define.h"

namespace sinew::effects::kinematic::free_play {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Free play";
  info.formula =
      "- s * b / 2 - c * tooth torque, s = 1 where the teeth drive up, -1 where they drive down";
  info.source =
      "Nordin, Gutman: Controlling mechanical systems with backlash - a survey (2002), "
      "section 2; thesis Fig 5.1";
  info.linear = {
      Linear("width", Dimension::kAngle, {0.0, 1.0}, "full width at the output, as backlash_rad"),
      Linear("compliance", Dimension::kAnglePerTorque, {0.0, 1.0},
             "of the teeth, from the gear's data sheet; 0: rigid")};
  info.signature = "the difference of the encoders jumps by b when the torque reverses";
  info.confounders = {"backlash_width", "gear_compliance"};
  info.separating_excitation = "none: only declared values distinguish them";
  info.needs = {"tooth_side", "tooth_torque_Nm"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants&, std::span<const double>,
                       std::span<double> phi) {
                      phi[0] = -0.5 * x.tooth_side;
                      phi[1] = -x.tooth_torque_Nm;
                    });
}

}  // namespace sinew::effects::kinematic::free_play
