// Torque constant that saturates.
#include "components/model/effects/define.h"

namespace sinew::effects::torque_constant_saturation {

std::unique_ptr<Effect> Make(const JointConstants& constants) {
  EffectInfo info;
  info.name = "torque_constant_saturation";
  info.title = "Torque constant that saturates";
  info.formula = "- s * N Kt I^3";
  info.source =
      "Hendershot, Miller: Design of Brushless Permanent-Magnet Machines, saturation; first even "
      "term of Kt(I)";
  info.side = Side::kMotor;
  info.linear = {{.name = "saturation",
                  .dimension = Dimension::kPerCurrentSquared,
                  .lower = 0.0,
                  .upper = 1.0,
                  .default_value = 0.0,
                  .meaning = "relative loss of the torque constant per squared ampere",
                  .relative_to_drive = true}};
  info.signature = "less torque than declared at high current, odd in current";
  info.variable = "drive_input";
  info.confounders = {"torque_constant_gain", "load_dependent_friction"};
  info.separating_excitation = "known loads up to the current limit";
  info.needs = {"drive_input"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants& c, std::span<const double>,
                       std::span<double> phi) {
                      const double u = x.drive_input;
                      phi[0] = -IdealDriveGain(c) * u * u * u;
                    });
}

}  // namespace sinew::effects::torque_constant_saturation
