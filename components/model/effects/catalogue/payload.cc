// An undeclared payload.
#include "components/model/effects/define.h"

namespace sinew::effects::payload {

std::unique_ptr<Effect> Make(const JointConstants& constants) {
  EffectInfo info;
  info.name = "payload";
  info.title = "Undeclared payload";
  info.formula = "- m * (l^2 * a + g * l * cos q)";
  info.rotary_only = true;
  info.source = "Newton";
  info.linear = {{.name = "payload",
                  .dimension = Dimension::kMass,
                  .lower = -20.0,
                  .upper = 20.0,
                  .default_value = 0.0,
                  .meaning = "mass at the load cell"}};
  info.signature = "residual follows cos q and acceleration in the ratio g : l";
  info.variable = "position_rad";
  info.confounders = {"gravity", "link_inertia"};
  info.separating_excitation = "a run with a known payload, over the whole angle range";
  info.needs = {"acceleration_rad_s2", "position_rad"};
  return Memoryless(
      constants, std::move(info),
      [](const JointSample& x, const JointConstants& c, std::span<const double>,
         std::span<double> phi) {
        const double l = c.link_length_m;
        phi[0] = -l * (l * x.acceleration_rad_s2 + c.gravity_m_s2 * std::cos(x.position_rad));
      });
}

}  // namespace sinew::effects::payload
