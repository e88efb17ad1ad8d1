// Drive torque as a sensor at the output reads it: joint torque sensor, or load cell at a piston.
#include "components/model/effects/define.h"

namespace sinew::effects::drive_torque {

std::unique_ptr<Effect> Make(const JointConstants& constants) {
  EffectInfo info;
  info.name = "drive_torque";
  info.title = "Measured drive torque";
  info.formula = "+ gain * T";
  info.source = "Khalil, Dombre: Modeling, Identification and Control of Robots (2002), 12.2";
  info.role = Role::kDrive;
  info.side = Side::kMotor;
  info.linear = {{.name = "gain",
                  .dimension = Dimension::kNone,
                  .lower = 0.5,
                  .upper = 2.0,
                  .default_value = 1.0,
                  .meaning = "1: the sensor is exact; fixed where the sensor is trusted"}};
  info.signature = "none: it is the input";
  info.variable = "drive_input";
  info.confounders = {"torque_constant_gain"};
  info.separating_excitation = "a known load to fix the scale";
  info.needs = {"drive_input"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants&, std::span<const double>,
                       std::span<double> phi) { phi[0] = x.drive_input; });
}

}  // namespace sinew::effects::drive_torque
