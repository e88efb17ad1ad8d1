// Drive force of an axis whose current loop is commanded in volts.
#include "components/model/effects/define.h"

namespace sinew::effects::drive_voltage {

std::unique_ptr<Effect> Make(const JointConstants& constants) {
  EffectInfo info;
  info.name = "drive_voltage";
  info.title = "Drive force from controller voltage";
  info.formula = "+ gain * u";
  info.source =
      "Janot, Gautier, Brunot: Data Set and Reference Models of EMPS (2019), force = gtau u";
  info.role = Role::kDrive;
  info.side = Side::kMotor;
  info.linear = {{.name = "gain",
                  .dimension = Dimension::kTorquePerVolt,
                  .lower = 1e-3,
                  .upper = 1e4,
                  .default_value = IdealDriveGain(constants),
                  .meaning = "torque or force at the output per volt"}};
  info.signature = "none: it is the input";
  info.variable = "drive_input";
  info.confounders = {"torque_constant_gain"};
  info.separating_excitation = "a known load to fix the scale";
  info.needs = {"drive_input"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants&, std::span<const double>,
                       std::span<double> phi) { phi[0] = x.drive_input; });
}

}  // namespace sinew::effects::drive_voltage
