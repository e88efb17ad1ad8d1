#include "components/model/effects/define.h"

namespace sinew::effects::pneumatic_torque {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Pneumatic torque";
  info.formula = "+ K * P";
  info.source = "thesis (5.4), K = 0.3587 Nm/bar";
  info.linear = {Linear("pneumatic_torque", Dimension::kTorquePerBar, {0.0, 1e3},
                        "torque per gauge pressure at the rest angle")};
  info.signature = "residual follows pressure";
  info.confounders = {"pressure_gain", "pneumatic_stiffness"};
  info.separating_excitation = "pressure steps at one angle";
  info.needs = {"pressure_bar"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x) { return x.pressure_bar; });
}

}  // namespace sinew::effects::pneumatic_torque
