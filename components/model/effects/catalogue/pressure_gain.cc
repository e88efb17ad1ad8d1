#include "components/model/effects/define.h"

namespace sinew::effects::pressure_gain {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Pressure sensor gain";
  info.formula = "- gain * (K P - k1 P (q - q0))";
  info.source = "P / (1 + gain) put into K P - k1 P (q - q0), first order";
  info.linear = {
      Linear("gain", Dimension::kNone, {-0.5, 0.5}, "share that the sensor reads too much")};
  info.signature = "residual proportional to the pneumatic torque";
  info.confounders = {"pneumatic_torque"};
  info.separating_excitation =
      "a second pressure gauge; a refit of the pneumatic torque absorbs it";
  info.needs = {"pressure_bar", "position_rad"};
  info.needs_pneumatics = true;
  return Memoryless(constants, std::move(info), [](const JointSample& x, const JointConstants& c) {
    return -x.pressure_bar * TorquePerBar(c, x.position_rad);
  });
}

}  // namespace sinew::effects::pressure_gain
