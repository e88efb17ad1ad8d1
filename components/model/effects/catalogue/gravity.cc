// Gravity of the link.
#include "components/model/effects/define.h"

namespace sinew::effects::gravity {

std::unique_ptr<Effect> Make(const JointConstants& constants) {
  EffectInfo info;
  info.name = "gravity";
  info.title = "Gravity of the link";
  info.formula = "- Tg * cos q";
  info.rotary_only = true;
  info.source = "thesis (5.1)-(5.2)";
  info.linear = {{.name = "gravity_torque",
                  .dimension = Dimension::kTorque,
                  .lower = 0.0,
                  .upper = 1e3,
                  .default_value = 0.0,
                  .meaning = "torque with the link horizontal, without declared payload"}};
  info.signature = "residual follows cos q";
  info.variable = "position_rad";
  info.confounders = {"payload", "gravity_phase", "gear_eccentricity"};
  info.separating_excitation = "slow motion over the whole angle range";
  info.needs = {"position_rad"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants&, std::span<const double>,
                       std::span<double> phi) { phi[0] = -std::cos(x.position_rad); });
}

}  // namespace sinew::effects::gravity
