// Drive torque of a current-commanded motor behind a gear, at the output. Positive current drives
// up.
#include "components/model/effects/define.h"

namespace sinew::effects::drive_current {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Drive torque from motor current";
  info.formula = "+ efficiency * N * Kt * I";
  info.source = "thesis (3.1), (4.21); Kt = 60 / (2 pi KV)";
  info.role = Role::kDrive;
  info.side = Side::kMotor;
  info.linear = {Linear("efficiency", Dimension::kNone, {0.2, 1.2},
                        "share of the ideal torque N Kt I that reaches the output", 0.77)};
  info.signature = "none: it is the input";
  info.confounders = {"torque_constant_gain", "drive_efficiency_direction"};
  info.separating_excitation =
      "motion in both directions of power, with a known load to fix the scale";
  info.needs = {"drive_input"};
  return Memoryless(constants, std::move(info), [](const JointSample& x, const JointConstants& c) {
    return c.gear_ratio * c.torque_constant_Nm_A * x.drive_input;
  });
}

}  // namespace sinew::effects::drive_current
