// Constant torque.
#include "components/model/effects/define.h"

namespace sinew::effects::offset {

std::unique_ptr<Effect> Make(const JointConstants& constants) {
  EffectInfo info;
  info.name = "offset";
  info.title = "Constant torque";
  info.formula = "+ offset";
  info.source = "current sensor or amplifier zero; EMPS report";
  info.linear = {{.name = "offset",
                  .dimension = Dimension::kTorque,
                  .lower = -1e3,
                  .upper = 1e3,
                  .default_value = 0.0,
                  .meaning = "torque that is always there"}};
  info.signature = "constant residual";
  info.variable = "none";
  info.confounders = {"direction_dependent_coulomb", "current_offset"};
  info.separating_excitation = "rest and slow motion in both directions";
  info.needs = {};
  return Memoryless(constants, std::move(info),
                    [](const JointSample&, const JointConstants&, std::span<const double>,
                       std::span<double> phi) { phi[0] = 1.0; });
}

}  // namespace sinew::effects::offset
