#include "components/model/effects/define.h"

namespace sinew::effects::gravity {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Gravity of the link";
  info.formula = "- Tg * cos q";
  info.rotary_only = true;
  info.source = "thesis (5.1)-(5.2)";
  info.linear = {Linear("gravity_torque", Dimension::kTorque, {0.0, 1e3},
                        "torque with the link horizontal, without declared payload")};
  info.signature = "residual follows cos q";
  info.confounders = {"payload", "gravity_phase", "gear_eccentricity"};
  info.separating_excitation = "slow motion over the whole angle range";
  info.needs = {"position_rad"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x) { return -std::cos(x.position_rad); });
}

}  // namespace sinew::effects::gravity
