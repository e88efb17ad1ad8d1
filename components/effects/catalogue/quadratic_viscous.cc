// Quadratic viscous friction.
#include "components/effects/define.h"

namespace sinew::effects::quadratic_viscous {

std::unique_ptr<Effect> Make(const JointConstants& constants) {
  EffectInfo info;
  info.name = "quadratic_viscous";
  info.title = "Quadratic viscous friction";
  info.formula = "- c * v * |v|";
  info.source = "White: Fluid Mechanics, turbulent drag";
  info.linear = {{.name = "quadratic",
                  .dimension = Dimension::kQuadraticViscous,
                  .lower = 0.0,
                  .upper = 1e5,
                  .default_value = 0.0,
                  .meaning = "torque per squared velocity"}};
  info.signature = "residual odd in velocity, growing with its square";
  info.variable = "velocity_rad_s";
  info.look_alikes = {"viscous", "motor_viscous", "stribeck"};
  info.separating_excitation = "constant speeds over the whole range, both directions";
  info.needs = {"velocity_rad_s"};
  return Memoryless(
      constants, std::move(info),
      [](const JointSample& x, const JointConstants&, std::span<const double>,
         std::span<double> phi) { phi[0] = -x.velocity_rad_s * std::abs(x.velocity_rad_s); });
}

}  // namespace sinew::effects::quadratic_viscous
