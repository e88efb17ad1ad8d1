// Free play wider (or narrower) than declared.
#include "components/model/effects/define.h"

namespace sinew::effects::kinematic::backlash_width {

std::unique_ptr<Effect> Make(const JointConstants& constants) {
  EffectInfo info;
  info.name = "backlash_width";
  info.title = "Free play of another width";
  info.formula = "- s * db / 2";
  info.source =
      "Nordin, Gutman: Controlling mechanical systems with backlash - a survey (2002), "
      "section 2";
  info.balance = Balance::kKinematic;
  info.linear = {{.name = "extra_width",
                  .dimension = Dimension::kAngle,
                  .lower = -0.5,
                  .upper = 0.5,
                  .default_value = 0.0,
                  .meaning = "full width beyond the declared one"}};
  info.signature = "difference of the encoders jumps further than declared, whatever the torque";
  info.variable = "tooth_side";
  info.confounders = {"gear_compliance", "free_play"};
  info.separating_excitation = "small and large torque on either side: play does not grow with it";
  info.needs = {"tooth_side"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants&, std::span<const double>,
                       std::span<double> phi) { phi[0] = -0.5 * x.tooth_side; });
}

}  // namespace sinew::effects::kinematic::backlash_width
