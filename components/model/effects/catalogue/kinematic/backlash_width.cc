// Free play wider (or narrower) than declared.
#include "components/model/effects/define.h"

namespace sinew::effects::kinematic::backlash_width {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Free play of another width";
  info.formula = "- s * db / 2";
  info.source =
      "Nordin, Gutman: Controlling mechanical systems with backlash - a survey (2002), "
      "section 2";
  info.linear = {
      Linear("extra_width", Dimension::kAngle, {-0.5, 0.5}, "full width beyond the declared one")};
  info.signature = "difference of the encoders jumps further than declared, whatever the torque";
  info.confounders = {"gear_compliance", "free_play"};
  info.separating_excitation = "small and large torque on either side: play does not grow with it";
  info.needs = {"tooth_side"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x) { return -0.5 * x.tooth_side; });
}

}  // namespace sinew::effects::kinematic::backlash_width
