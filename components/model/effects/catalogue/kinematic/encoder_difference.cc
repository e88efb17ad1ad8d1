// The measured side of the kinematic balance.
#include "components/model/effects/define.h"

namespace sinew::effects::kinematic::encoder_difference {

std::unique_ptr<Effect> Make(const JointConstants& constants) {
  EffectInfo info;
  info.name = "encoder_difference";
  info.title = "Difference of the encoders";
  info.formula = "+ (motor angle / N - q)";
  info.source = "definition";
  info.role = Role::kDrive;  // what is measured; everything else has to explain it
  info.balance = Balance::kKinematic;
  info.linear = {{.name = "share",
                  .dimension = Dimension::kNone,
                  .lower = 1.0 - 1e-9,
                  .upper = 1.0 + 1e-9,
                  .default_value = 1.0,
                  .meaning = "1: the difference is exact"}};
  info.signature = "none: it is what the balance is about";
  info.variable = "drive_input";
  info.needs = {"drive_input"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants&, std::span<const double>,
                       std::span<double> phi) { phi[0] = x.drive_input; });
}

}  // namespace sinew::effects::kinematic::encoder_difference
