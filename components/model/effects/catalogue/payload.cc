// An undeclared payload.
#include "components/model/effects/define.h"

namespace sinew::effects::payload {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Undeclared payload";
  info.formula = "- m * (l^2 * a + g * l * cos q)";
  info.rotary_only = true;
  info.source = "Newton";
  info.linear = {Linear("payload", Dimension::kMass, {-20.0, 20.0}, "mass at the load cell")};
  info.signature = "residual follows cos q and acceleration in the ratio g : l";
  info.variable = "position_rad";
  info.confounders = {"gravity", "link_inertia"};
  info.separating_excitation = "a run with a known payload, over the whole angle range";
  info.needs = {"acceleration_rad_s2", "position_rad"};
  return Memoryless(constants, std::move(info), [](const JointSample& x, const JointConstants& c) {
    const double l = c.link_length_m;
    return -l * (l * x.acceleration_rad_s2 + c.gravity_m_s2 * std::cos(x.position_rad));
  });
}

}  // namespace sinew::effects::payload
