// Skew between the two encoders: T > 0 when the motor's angle is recorded late.
#include "components/model/effects/define.h"

namespace sinew::effects::kinematic::transport_delay {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Skew between the encoders";
  info.formula = "+ T * v";
  info.source = "first order of q(t - T)";
  info.smallest = Smallest::kTenthOfSample;
  info.linear = {Linear("delay", Dimension::kTime, {-0.1, 0.1},
                        "the motor's angle is recorded this much later than the output's")};
  info.signature = "difference of the encoders follows the velocity";
  info.confounders = {"gear_compliance"};
  info.separating_excitation = "the same velocity at different load: a skew does not see the load";
  info.needs = {"velocity_rad_s"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x) { return x.velocity_rad_s; });
}

}  // namespace sinew::effects::kinematic::transport_delay
