// Pneumatic stiffness. K P and k1 q0 P are proportional to the same signal: with q0 held, the
// least squares of K and k1 is well posed.
#include "components/model/effects/define.h"

namespace sinew::effects::pneumatic_stiffness {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Pneumatic stiffness";
  info.formula = "- k1 * P * (q - q0)";
  info.source = "thesis (5.5), rig balance";
  info.linear = {Linear("pneumatic_stiffness", Dimension::kStiffnessPerBar, {0.0, 1e4},
                        "restoring stiffness per gauge pressure")};
  info.nonlinear = {
      {.name = "rest_angle",
       .dimension = Dimension::kAngle,
       .lower = -3.2,
       .upper = 3.2,
       .default_value = 0.0,
       .grid = {-0.4, -0.2, 0.0, 0.2, 0.4},
       .meaning = "q0; K - k1 q0 is one direction of the data, so model files fix it"}};
  info.signature = "residual follows P (q - q0)";
  info.variable = "position_rad";
  info.confounders = {"pneumatic_torque", "pressure_offset"};
  info.separating_excitation = "pressure steps at several angles";
  info.needs = {"pressure_bar", "position_rad"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants&, std::span<const double> psi) {
                      return -x.pressure_bar * (x.position_rad - psi[0]);
                    });
}

}  // namespace sinew::effects::pneumatic_stiffness
