// Viscous friction on the output.
#include "components/model/effects/define.h"

namespace sinew::effects::viscous {

std::unique_ptr<Effect> Make(const JointConstants& constants) {
  EffectInfo info;
  info.name = "viscous";
  info.title = "Viscous friction on the output";
  info.formula = "- B * v";
  info.source = "Khalil, Dombre: Modeling, Identification and Control of Robots (2002)";
  info.linear = {{.name = "viscous",
                  .dimension = Dimension::kViscous,
                  .lower = 0.0,
                  .upper = 1e4,
                  .default_value = 0.0,
                  .meaning = "torque per velocity, at the output"}};
  info.signature = "residual linear in velocity";
  info.variable = "velocity_rad_s";
  info.confounders = {"motor_viscous", "quadratic_viscous", "stribeck"};
  info.separating_excitation = "constant speeds, several, both directions";
  info.needs = {"velocity_rad_s"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants&, std::span<const double>,
                       std::span<double> phi) { phi[0] = -x.velocity_rad_s; });
}

}  // namespace sinew::effects::viscous
