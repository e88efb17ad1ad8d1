#include "components/model/effects/define.h"

namespace sinew::effects::torque_constant_gain {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Torque constant other than declared";
  info.formula = "+ gain * N Kt I";
  info.source = "magnet temperature and convention of Kt";
  info.side = Side::kMotor;
  // Wrong by more than half, it is another sensor or drive.
  info.linear = {RelativeToDrive(
      Linear("gain", Dimension::kNone, {-0.5, 0.5}, "relative error of the torque constant"))};
  info.signature = "residual proportional to drive torque";
  info.confounders = {"drive_current", "drive_voltage"};
  info.separating_excitation = "a load of known weight; a refit of the drive factor absorbs it";
  info.needs = {"drive_input"};
  return Memoryless(constants, std::move(info), [](const JointSample& x, const JointConstants& c) {
    return IdealDriveGain(c) * x.drive_input;
  });
}

}  // namespace sinew::effects::torque_constant_gain
