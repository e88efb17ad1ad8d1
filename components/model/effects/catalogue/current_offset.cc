// Zero error of the current sensor.
#include "components/model/effects/define.h"

namespace sinew::effects::current_offset {

std::unique_ptr<Effect> Make(const JointConstants& constants) {
  EffectInfo info;
  info.name = "current_offset";
  info.title = "Zero error of the current sensor";
  info.formula = "+ N Kt * I0";
  info.source = "amplifier zero";
  info.side = Side::kMotor;
  info.linear = {{.name = "current_offset",
                  .dimension = Dimension::kCurrent,
                  .lower = -20.0,
                  .upper = 20.0,
                  .default_value = 0.0,
                  .meaning = "true minus measured drive input",
                  .relative_to_drive = true}};
  info.signature = "constant residual";
  info.variable = "none";
  info.confounders = {"offset", "direction_dependent_coulomb"};
  info.separating_excitation = "current read with the drive off";
  info.needs = {};
  return Memoryless(constants, std::move(info),
                    [](const JointSample&, const JointConstants& c, std::span<const double>,
                       std::span<double> phi) { phi[0] = IdealDriveGain(c); });
}

}  // namespace sinew::effects::current_offset
