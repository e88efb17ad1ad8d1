// Compliant gear.
#include "components/model/effects/define.h"

namespace sinew::effects::gear_compliance {

std::unique_ptr<Effect> Make(const JointConstants& constants) {
  EffectInfo info;
  info.name = "gear_compliance";
  info.title = "Compliant gear";
  info.formula = "- c * snap";
  info.source =
      "series spring: Spong, Modeling and Control of Elastic Joint Robots (1987); c = Jm Jl / k, "
      "negative when the encoder sits on the motor side";
  info.smallest = Smallest::kBandwidth;
  info.linear = {{.name = "compliance",
                  .dimension = Dimension::kInertiaTimeSquared,
                  .lower = -10.0,
                  .upper = 10.0,
                  .default_value = 0.0,
                  .meaning = "torque per snap; divided by the inertia a squared time"}};
  info.signature = "residual at high frequency, opposed to acceleration or in phase with it";
  info.variable = "snap_rad_s4";
  info.confounders = {"flexible_link", "elastic_joint", "transport_delay", "inertia"};
  info.separating_excitation = "pulses and chirps up to the resonance";
  info.needs = {"snap_rad_s4"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants&, std::span<const double>,
                       std::span<double> phi) { phi[0] = -x.snap_rad_s4; });
}

}  // namespace sinew::effects::gear_compliance
