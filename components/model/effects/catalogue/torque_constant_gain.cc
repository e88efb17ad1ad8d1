// Torque constant other than declared.
#include "components/model/effects/define.h"

namespace sinew::effects::torque_constant_gain {

std::unique_ptr<Effect> Make(const JointConstants& constants) {
  EffectInfo info;
  info.name = "torque_constant_gain";
  info.title = "Torque constant other than declared";
  info.formula = "+ gain * N Kt I";
  info.source = "magnet temperature and convention of Kt";
  info.side = Side::kMotor;
  info.linear = {{.name = "gain",
                  .dimension = Dimension::kNone,
                  .lower = -0.5,
                  .upper = 0.5,  // wrong by more than half, it is another sensor or drive
                  .default_value = 0.0,
                  .meaning = "relative error of the torque constant",
                  .relative_to_drive = true}};
  info.signature = "residual proportional to drive torque";
  info.variable = "drive_input";
  info.confounders = {"drive_current", "drive_voltage"};
  info.separating_excitation = "a load of known weight; a refit of the drive factor absorbs it";
  info.needs = {"drive_input"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants& c, std::span<const double>,
                       std::span<double> phi) { phi[0] = IdealDriveGain(c) * x.drive_input; });
}

}  // namespace sinew::effects::torque_constant_gain
