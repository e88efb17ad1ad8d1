// Quadratic viscous friction of the fast side of the gear: what turns in oil or grease is the
// rotor. Without a motor encoder the gear is taken as rigid.
#include "components/model/effects/define.h"

namespace sinew::effects::quadratic_viscous {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Quadratic viscous friction";
  info.formula = "- c * w * |w|, w = v_motor / N";
  info.source = "White: Fluid Mechanics, turbulent drag";
  info.side = Side::kMotor;
  info.linear = {Linear("quadratic", Dimension::kQuadraticViscous, {0.0, 1e5},
                        "torque per squared velocity, at the output")};
  info.signature = "residual odd in velocity, growing with its square";
  info.confounders = {"viscous", "motor_viscous", "stribeck"};
  info.separating_excitation = "constant speeds over the whole range, both directions";
  info.needs = {"motor_velocity_rad_s"};
  return Memoryless(constants, std::move(info), [](const JointSample& x, const JointConstants& c) {
    const double w = x.motor_velocity_rad_s / c.gear_ratio;
    return -w * std::abs(w);
  });
}

}  // namespace sinew::effects::quadratic_viscous
