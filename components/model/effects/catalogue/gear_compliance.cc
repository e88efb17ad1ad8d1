#include "components/model/effects/define.h"

namespace sinew::effects::gear_compliance {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Compliant gear";
  info.formula = "- c * snap";
  info.source =
      "series spring: Spong, Modeling and Control of Elastic Joint Robots (1987); c = Jm Jl / k, "
      "negative when the encoder sits on the motor side";
  info.smallest = Smallest::kBandwidth;
  info.linear = {Linear("compliance", Dimension::kInertiaTimeSquared, {-10.0, 10.0},
                        "torque per snap; divided by the inertia a squared time")};
  info.signature = "residual at high frequency, opposed to acceleration or in phase with it";
  info.confounders = {"flexible_link", "elastic_joint", "transport_delay", "inertia"};
  info.separating_excitation = "pulses and chirps up to the resonance";
  info.needs = {"snap_rad_s4"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x) { return -x.snap_rad_s4; });
}

}  // namespace sinew::effects::gear_compliance
