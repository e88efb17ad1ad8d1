// Pneumatic torque.
#include "components/model/effects/define.h"

namespace sinew::effects::pneumatic_torque {

std::unique_ptr<Effect> Make(const JointConstants& constants) {
  EffectInfo info;
  info.name = "pneumatic_torque";
  info.title = "Pneumatic torque";
  info.formula = "+ K * P";
  info.source = "thesis (5.4), K = 0.3587 Nm/bar";
  info.linear = {{.name = "pneumatic_torque",
                  .dimension = Dimension::kTorquePerBar,
                  .lower = 0.0,
                  .upper = 1e3,
                  .default_value = 0.0,
                  .meaning = "torque per gauge pressure at the rest angle"}};
  info.signature = "residual follows pressure";
  info.variable = "pressure_bar";
  info.confounders = {"pressure_gain", "pneumatic_stiffness"};
  info.separating_excitation = "pressure steps at one angle";
  info.needs = {"pressure_bar"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants&, std::span<const double>,
                       std::span<double> phi) { phi[0] = x.pressure_bar; });
}

}  // namespace sinew::effects::pneumatic_torque
