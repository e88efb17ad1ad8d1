#include "components/model/effects/define.h"

namespace sinew::effects::offset {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Constant torque";
  info.formula = "+ offset";
  info.source = "current sensor or amplifier zero; EMPS report";
  info.linear = {Linear("offset", Dimension::kTorque, {-1e3, 1e3}, "torque that is always there")};
  info.signature = "constant residual";
  info.variable = "none";
  info.confounders = {"direction_dependent_coulomb", "current_offset"};
  info.separating_excitation = "rest and slow motion in both directions";
  return Memoryless(constants, std::move(info), [](const JointSample&) { return 1.0; });
}

}  // namespace sinew::effects::offset
