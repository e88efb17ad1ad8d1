#include "components/model/effects/define.h"

namespace sinew::effects::current_offset {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Zero error of the current sensor";
  info.formula = "+ N Kt * I0";
  info.source = "amplifier zero";
  info.side = Side::kMotor;
  info.linear = {RelativeToDrive(Linear("current_offset", Dimension::kCurrent, {-20.0, 20.0},
                                        "true minus measured drive input"))};
  info.signature = "constant residual";
  info.variable = "none";
  info.confounders = {"offset", "direction_dependent_coulomb"};
  info.separating_excitation = "current read with the drive off";
  return Memoryless(constants, std::move(info),
                    [](const JointSample&, const JointConstants& c) { return IdealDriveGain(c); });
}

}  // namespace sinew::effects::current_offset
