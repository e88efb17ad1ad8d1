// Pressure sensor zero.
#include "components/model/effects/define.h"

namespace sinew::effects::pressure_offset {

std::unique_ptr<Effect> Make(const JointConstants& constants) {
  EffectInfo info;
  info.name = "pressure_offset";
  info.title = "Pressure sensor zero";
  info.formula = "+ T0 - k0 * q, T0 = P0 (K + k1 q0), k0 = k1 P0";
  info.source = "sensor calibration put into K P - k1 P (q - q0)";
  info.linear = {{.name = "torque",
                  .dimension = Dimension::kTorque,
                  .lower = -100.0,
                  .upper = 100.0,
                  .default_value = 0.0,
                  .meaning = "torque at q = 0"},
                 {.name = "stiffness",
                  .dimension = Dimension::kStiffness,
                  .lower = -1e3,
                  .upper = 1e3,
                  .default_value = 0.0,
                  .meaning = "stiffness at zero indicated pressure"}};
  info.signature = "a spring that is there at every pressure";
  info.variable = "position_rad";
  info.confounders = {"offset", "pneumatic_stiffness"};
  info.separating_excitation = "the vented chamber, over the whole angle range";
  info.needs = {"position_rad"};
  info.hardware = {"pressure_bar"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants&, std::span<const double>,
                       std::span<double> phi) {
                      phi[0] = 1.0;
                      phi[1] = -x.position_rad;
                    });
}

}  // namespace sinew::effects::pressure_offset
