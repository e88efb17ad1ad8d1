// Tilted base or angle zero: everything that hangs on the link pulls at another angle, the payload
// that the operator declared as well. Of the link, what stays in phase the gravity term carries.
#include "components/effects/define.h"

namespace sinew::effects::gravity_phase {

std::unique_ptr<Effect> Make(const JointConstants& constants) {
  EffectInfo info;
  info.name = "gravity_phase";
  info.title = "Tilted base or angle zero";
  info.formula =
      "+ Tq * sin q + m * g * l * (s * sin q + c * cos q), Tq = Tg * sin(tilt), s = sin(tilt), "
      "c = 1 - cos(tilt)";
  info.rotary_only = true;
  info.source = "cos(q + tilt) expanded";
  info.linear = {{.name = "quadrature",
                  .dimension = Dimension::kTorque,
                  .lower = -1e3,
                  .upper = 1e3,
                  .default_value = 0.0,
                  .meaning = "gravity torque times the sine of the tilt"},
                 {.name = "payload_quadrature",
                  .dimension = Dimension::kNone,
                  .lower = -1.0,
                  .upper = 1.0,
                  .default_value = 0.0,
                  .meaning = "s, as the declared payload tells it"},
                 {.name = "payload_in_phase",
                  .dimension = Dimension::kNone,
                  .lower = 0.0,
                  .upper = 1.0,
                  .default_value = 0.0,
                  .meaning = "c, as the declared payload tells it"}};
  info.signature = "residual follows sin q";
  info.variable = "position_rad";
  info.look_alikes = {"gear_eccentricity", "offset"};
  info.separating_excitation = "slow motion over the whole angle range";
  info.needs = {"position_rad"};
  info.may_read = {"payload_kg"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants& c, std::span<const double>,
                       std::span<double> phi) {
                      phi[0] = std::sin(x.position_rad);
                      const double payload_Nm = x.payload_kg * c.gravity_m_s2 * c.link_length_m;
                      phi[1] = payload_Nm * phi[0];
                      phi[2] = payload_Nm * std::cos(x.position_rad);
                    });
}

}  // namespace sinew::effects::gravity_phase
