// Drive force of an axis whose current loop is commanded in volts.
#include "components/model/effects/define.h"

namespace sinew::effects::drive_voltage {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Drive force from controller voltage";
  info.formula = "+ gain * u";
  info.source =
      "Janot, Gautier, Brunot: Data Set and Reference Models of EMPS (2019), force = gtau u";
  info.role = Role::kDrive;
  info.side = Side::kMotor;
  info.linear = {Linear("gain", Dimension::kTorquePerVolt, {1e-3, 1e4},
                        "torque or force at the output per volt", IdealDriveGain(constants))};
  info.signature = "none: it is the input";
  info.confounders = {"torque_constant_gain"};
  info.separating_excitation = "a known load to fix the scale";
  info.needs = {"drive_input"};
  return Memoryless(constants, std::move(info), [](const JointSample& x) { return x.drive_input; });
}

}  // namespace sinew::effects::drive_voltage
