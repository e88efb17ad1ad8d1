// The measured side of the gas balance.
#include "components/model/effects/define.h"

namespace sinew::effects::gas::chamber_pressure {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Pressure of the chamber";
  info.formula = "+ P";
  info.source = "definition";
  info.role = Role::kDrive;  // what is measured; everything else has to explain it
  info.linear = {Linear("share", Dimension::kNone, {1.0 - 1e-9, 1.0 + 1e-9},
                        "1: the pressure is what the balance is about", 1.0)};
  info.signature = "none: it is what the balance is about";
  info.needs = {"drive_input"};
  return Memoryless(constants, std::move(info), [](const JointSample& x) { return x.drive_input; });
}

}  // namespace sinew::effects::gas::chamber_pressure
