// Load that does not press at a right angle to the link: the arm of the force is l cos(q - d)
// where the force keeps its direction in space, and l where it turns with the link. Written as
// what is beyond F l:
//
//     F l cos(q - d) = F l (cos q cos d + sin q sin d) = F l + sin d F l sin q + ...
#include "components/model/effects/define.h"

namespace sinew::effects::load_cell_misalignment {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Load that presses askew";
  info.formula = "- F * l * (a * sin q + b * (1 - cos q))";
  info.rotary_only = true;
  info.source = "geometry: arm of a force that does not turn with the link";
  info.linear = {Linear("tilt", Dimension::kNone, {-1.0, 1.0},
                        "a: sine of the angle between force and link's normal at q = 0"),
                 Linear("turn", Dimension::kNone, {-1.5, 1.5},
                        "b: -1 for a force that keeps its direction in space")};
  info.signature = "residual follows load force times the sine of the angle";
  info.confounders = {"load_cell_gain", "load_force"};
  info.separating_excitation = "the same push at several angles of the link";
  info.needs = {"load_force_N", "position_rad"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants& c, std::span<const double>,
                       std::span<double> phi) {
                      const double torque = -x.load_force_N * c.link_length_m;
                      phi[0] = torque * std::sin(x.position_rad);
                      phi[1] = torque * (1.0 - std::cos(x.position_rad));
                    });
}

}  // namespace sinew::effects::load_cell_misalignment
