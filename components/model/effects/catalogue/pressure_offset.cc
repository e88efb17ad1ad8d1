#include "components/model/effects/define.h"

namespace sinew::effects::pressure_offset {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Pressure sensor zero";
  info.formula = "- offset * (K - k1 (q - q0))";
  info.source = "P - offset put into K P - k1 P (q - q0)";
  info.linear = {
      Linear("offset", Dimension::kPressure, {-2.0, 2.0}, "what the sensor reads too much")};
  info.signature = "a spring that is there at every pressure";
  info.confounders = {"offset", "pneumatic_stiffness"};
  info.separating_excitation = "the vented chamber, over the whole angle range";
  info.needs = {"position_rad"};
  info.hardware = {"pressure_bar"};
  info.needs_pneumatics = true;
  return Memoryless(constants, std::move(info), [](const JointSample& x, const JointConstants& c) {
    return -TorquePerBar(c, x.position_rad);
  });
}

}  // namespace sinew::effects::pressure_offset
