#include "components/model/effects/define.h"

namespace sinew::effects::motor_viscous {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Viscous friction on the motor side of the gear";
  info.formula = "- B * v_motor / N";
  info.source = "thesis (4.21); rig balance";
  info.side = Side::kMotor;
  info.linear = {
      Linear("viscous", Dimension::kViscous, {0.0, 1e4}, "torque per velocity, at the output")};
  info.signature = "residual linear in motor velocity, also inside the free play";
  info.confounders = {"viscous", "quadratic_viscous", "stribeck"};
  info.separating_excitation = "motor motion inside the free play";
  info.needs = {"motor_velocity_rad_s"};
  return Memoryless(constants, std::move(info), [](const JointSample& x, const JointConstants& c) {
    return -x.motor_velocity_rad_s / c.gear_ratio;
  });
}

}  // namespace sinew::effects::motor_viscous
