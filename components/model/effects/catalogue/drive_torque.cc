// Drive torque as a sensor at the output reads it: joint torque sensor, or load cell at a piston.
#include "components/model/effects/define.h"

namespace sinew::effects::drive_torque {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Measured drive torque";
  info.formula = "+ gain * T";
  info.source = "Khalil, Dombre: Modeling, Identification and Control of Robots (2002), 12.2";
  info.role = Role::kDrive;
  info.side = Side::kMotor;
  info.linear = {Linear("gain", Dimension::kNone, {0.5, 2.0},
                        "1: the sensor is exact; fixed where the sensor is trusted", 1.0)};
  info.signature = "none: it is the input";
  info.confounders = {"torque_constant_gain"};
  info.separating_excitation = "a known load to fix the scale";
  info.needs = {"drive_input"};
  return Memoryless(constants, std::move(info), [](const JointSample& x) { return x.drive_input; });
}

}  // namespace sinew::effects::drive_torque
