// Pressure sensor with an offset: compression acts on the true pressure.
#include "components/model/effects/define.h"

namespace sinew::effects::gas::pressure_offset {

std::unique_ptr<Effect> Make(const JointConstants& constants) {
  EffectInfo info;
  info.name = "pressure_offset";
  info.title = "Offset of the pressure sensor";
  info.formula = "+ P0 * integral of dV/dt / V";
  info.source = "sensor calibration; a gain g looks like the offset Pa (1 / g - 1)";
  info.balance = Balance::kGas;
  info.rate = true;
  info.linear = {{.name = "offset",
                  .dimension = Dimension::kPressure,
                  .lower = -2.0,
                  .upper = 2.0,
                  .default_value = 0.0,
                  .meaning = "true pressure minus reading"}};
  info.signature = "response to compression does not grow with pressure as it should";
  info.variable = "pressure_bar";
  info.confounders = {"gas_compression"};
  info.separating_excitation = "the same stroke at low and at high pressure";
  info.needs = {"volume_rate_1_s"};
  return Memoryless(
      constants, std::move(info),
      [](const JointSample& x, const JointConstants&, std::span<const double>,
         std::span<double> phi) { phi[0] = (x.valve_open ? 0.0 : 1.0) * x.volume_rate_1_s; });
}

}  // namespace sinew::effects::gas::pressure_offset
