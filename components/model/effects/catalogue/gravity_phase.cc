// Tilted base or angle zero: everything that hangs on the link pulls at another angle, the payload
// that the operator declared as well. What stays in phase, 1 - cos tilt, the gravity term carries
// of the link, and is left out of the payload: a free part would be a load cell's gain.
#include "components/model/effects/define.h"

namespace sinew::effects::gravity_phase {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Tilted base or angle zero";
  info.formula = "+ (Tq + s * m * g * l) * sin q, Tq = Tg * sin(tilt), s = sin(tilt)";
  info.rotary_only = true;
  info.source = "cos(q + tilt) expanded";
  info.linear = {
      Linear("quadrature", Dimension::kTorque, {-1e3, 1e3},
             "gravity torque times the sine of the tilt"),
      Linear("payload_quadrature", Dimension::kNone, {-1.0, 1.0}, "s, from the declared payload")};
  info.signature = "residual follows sin q";
  info.confounders = {"gear_eccentricity", "offset"};
  info.separating_excitation = "slow motion over the whole angle range";
  info.needs = {"position_rad"};
  info.may_read = {"payload_kg"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants& c, std::span<const double>,
                       std::span<double> phi) {
                      phi[0] = std::sin(x.position_rad);
                      phi[1] = x.payload_kg * c.gravity_m_s2 * c.link_length_m * phi[0];
                    });
}

}  // namespace sinew::effects::gravity_phase
