// Skew between the two encoders: T > 0 when the motor's angle is recorded late.
#include "components/model/effects/define.h"

namespace sinew::effects::kinematic::transport_delay {

std::unique_ptr<Effect> Make(const JointConstants& constants) {
  EffectInfo info;
  info.name = "transport_delay";
  info.title = "Skew between the encoders";
  info.formula = "+ T * v";
  info.source = "first order of q(t - T)";
  info.balance = Balance::kKinematic;
  info.smallest = Smallest::kTenthOfSample;
  info.linear = {{.name = "delay",
                  .dimension = Dimension::kTime,
                  .lower = -0.1,
                  .upper = 0.1,
                  .default_value = 0.0,
                  .meaning = "the motor's angle is recorded this much later than the output's"}};
  info.signature = "difference of the encoders follows the velocity";
  info.variable = "velocity_rad_s";
  info.confounders = {"gear_compliance"};
  info.separating_excitation = "the same velocity at different load: a skew does not see the load";
  info.needs = {"velocity_rad_s"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants&, std::span<const double>,
                       std::span<double> phi) { phi[0] = x.velocity_rad_s; });
}

}  // namespace sinew::effects::kinematic::transport_delay
