#include "components/model/effects/define.h"

namespace sinew::effects::torque_constant_saturation {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Torque constant that saturates";
  info.formula = "- s * N Kt I^3";
  info.source =
      "Hendershot, Miller: Design of Brushless Permanent-Magnet Machines, saturation; first even "
      "term of Kt(I)";
  info.side = Side::kMotor;
  info.linear = {
      RelativeToDrive(Linear("saturation", Dimension::kPerCurrentSquared, {0.0, 1.0},
                             "relative loss of the torque constant per squared ampere"))};
  info.signature = "less torque than declared at high current, odd in current";
  info.confounders = {"torque_constant_gain", "load_dependent_friction"};
  info.separating_excitation = "known loads up to the current limit";
  info.needs = {"drive_input"};
  return Memoryless(constants, std::move(info), [](const JointSample& x, const JointConstants& c) {
    const double u = x.drive_input;
    return -IdealDriveGain(c) * u * u * u;
  });
}

}  // namespace sinew::effects::torque_constant_saturation
