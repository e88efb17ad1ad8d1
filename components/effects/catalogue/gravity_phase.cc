// Tilted base or angle zero.
#include "components/effects/define.h"

namespace sinew::effects::gravity_phase {

std::unique_ptr<Effect> Make(const JointConstants& constants) {
  EffectInfo info;
  info.name = "gravity_phase";
  info.title = "Tilted base or angle zero";
  info.formula = "+ Tq * sin q, Tq = Tg * sin(tilt)";
  info.rotary_only = true;
  info.source = "cos(q + tilt) expanded";
  info.linear = {{.name = "quadrature",
                  .dimension = Dimension::kTorque,
                  .lower = -1e3,
                  .upper = 1e3,
                  .default_value = 0.0,
                  .meaning = "gravity torque times the sine of the tilt"}};
  info.signature = "residual follows sin q";
  info.variable = "position_rad";
  info.look_alikes = {"gear_eccentricity", "offset"};
  info.separating_excitation = "slow motion over the whole angle range";
  info.needs = {"position_rad"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants&, std::span<const double>,
                       std::span<double> phi) { phi[0] = std::sin(x.position_rad); });
}

}  // namespace sinew::effects::gravity_phase
