// Pressure sensor zero.
#include "components/model/effects/define.h"

namespace sinew::effects::pressure_offset {

std::unique_ptr<Effect> Make(const JointConstants& constants) {
  EffectInfo info;
  info.name = "pressure_offset";
  info.title = "Pressure sensor zero";
  info.formula = "- offset * (K - k1 (q - q0))";
  info.source = "P - offset put into K P - k1 P (q - q0)";
  info.linear = {{.name = "offset",
                  .dimension = Dimension::kPressure,
                  .lower = -2.0,
                  .upper = 2.0,
                  .default_value = 0.0,
                  .meaning = "what the sensor reads too much"}};
  info.signature = "a spring that is there at every pressure";
  info.variable = "position_rad";
  info.confounders = {"offset", "pneumatic_stiffness"};
  info.separating_excitation = "the vented chamber, over the whole angle range";
  info.needs = {"position_rad"};
  info.hardware = {"pressure_bar"};
  info.needs_pneumatics = true;
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants& c, std::span<const double>,
                       std::span<double> phi) { phi[0] = -TorquePerBar(c, x.position_rad); });
}

}  // namespace sinew::effects::pressure_offset
