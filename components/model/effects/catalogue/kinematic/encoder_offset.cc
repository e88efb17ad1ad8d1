// Middle of the play: the encoders were zeroed somewhere.
#include "components/model/effects/define.h"

namespace sinew::effects::kinematic::encoder_offset {

std::unique_ptr<Effect> Make(const JointConstants& constants) {
  EffectInfo info;
  info.name = "encoder_offset";
  info.title = "Offset between the encoders";
  info.formula = "- y0";
  info.source = "definition";
  info.balance = Balance::kKinematic;
  info.linear = {{.name = "offset",
                  .dimension = Dimension::kAngle,
                  .lower = -10.0,
                  .upper = 10.0,
                  .default_value = 0.0,
                  .meaning = "motor angle / N - output angle in the middle of the play"}};
  info.signature = "constant difference of the encoders";
  info.variable = "time_s";
  return Memoryless(constants, std::move(info),
                    [](const JointSample&, const JointConstants&, std::span<const double>,
                       std::span<double> phi) { phi[0] = -1.0; });
}

}  // namespace sinew::effects::kinematic::encoder_offset
