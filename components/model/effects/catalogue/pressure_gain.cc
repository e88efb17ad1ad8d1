// Pressure sensor gain.
#include "components/model/effects/define.h"

namespace sinew::effects::pressure_gain {

std::unique_ptr<Effect> Make(const JointConstants& constants) {
  EffectInfo info;
  info.name = "pressure_gain";
  info.title = "Pressure sensor gain";
  info.formula = "+ g * P";
  info.source = "sensor calibration";
  info.linear = {{.name = "gain",
                  .dimension = Dimension::kTorquePerBar,
                  .lower = -1e2,
                  .upper = 1e2,
                  .default_value = 0.0,
                  .meaning = "error of the pneumatic torque per bar"}};
  info.signature = "residual proportional to pressure";
  info.variable = "pressure_bar";
  info.confounders = {"pneumatic_torque"};
  info.separating_excitation =
      "a second pressure gauge; a refit of the pneumatic torque absorbs it";
  info.needs = {"pressure_bar"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants&, std::span<const double>,
                       std::span<double> phi) { phi[0] = x.pressure_bar; });
}

}  // namespace sinew::effects::pressure_gain
