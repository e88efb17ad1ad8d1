// Middle of the play: the encoders were zeroed somewhere.
#include "components/model/effects/define.h"

namespace sinew::effects::kinematic::encoder_offset {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Offset between the encoders";
  info.formula = "- y0";
  info.source = "definition";
  info.linear = {Linear("offset", Dimension::kAngle, {-10.0, 10.0},
                        "motor angle / N - output angle in the middle of the play")};
  info.signature = "constant difference of the encoders";
  info.variable = "time_s";
  return Memoryless(constants, std::move(info), [](const JointSample&) { return -1.0; });
}

}  // namespace sinew::effects::kinematic::encoder_offset
