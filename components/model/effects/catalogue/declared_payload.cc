// Gravity and inertia of the mass that is known to hang at the load cell: an exactly known part, so
// model files fix its share at 1. A linear joint carries its inertia alone: its axis is taken as
// horizontal.
#include "components/model/effects/define.h"

namespace sinew::effects::declared_payload {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Payload that the operator declared";
  info.formula = "- share * m * (l^2 * a + g * l * cos q); - share * m * a on a linear joint";
  info.source = "rig balance; m = payload_kg";
  info.linear = {Linear("share", Dimension::kNone, {0.0, 2.0},
                        "1: the payload is as declared; fixed in model files", 1.0)};
  info.signature = "residual that changes with the declared payload";
  info.confounders = {"payload"};
  info.separating_excitation = "runs with and without payload";
  info.needs = {"payload_kg", "acceleration_rad_s2", "position_rad"};
  return Memoryless(constants, std::move(info), [](const JointSample& x, const JointConstants& c) {
    const double l = c.link_length_m;
    const double weight =
        c.kind == types::JointKind::kPrismatic ? 0.0 : c.gravity_m_s2 * std::cos(x.position_rad);
    return -x.payload_kg * l * (l * x.acceleration_rad_s2 + weight);
  });
}

}  // namespace sinew::effects::declared_payload
