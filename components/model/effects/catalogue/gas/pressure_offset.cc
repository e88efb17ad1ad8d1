// Pressure sensor with an offset: compression acts on the true pressure.
#include "components/model/effects/define.h"

namespace sinew::effects::gas::pressure_offset {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Offset of the pressure sensor";
  info.formula = "+ P0 * integral of dV/dt / V";
  info.source = "sensor calibration; a gain g looks like the offset Pa (1 / g - 1)";
  info.rate = true;
  info.linear = {
      Linear("offset", Dimension::kPressure, {-2.0, 2.0}, "true pressure minus reading")};
  info.signature = "response to compression does not grow with pressure as it should";
  info.variable = "pressure_bar";
  info.confounders = {"gas_compression"};
  info.separating_excitation = "the same stroke at low and at high pressure";
  info.needs = {"volume_rate_1_s"};
  return Memoryless(constants, std::move(info), [](const JointSample& x) {
    return (x.valve_open ? 0.0 : 1.0) * x.volume_rate_1_s;
  });
}

}  // namespace sinew::effects::gas::pressure_offset
