// Elasticity seen as a lag. With a spring k between drive and link and viscous friction B on the
// other side of it, the rigid balance lacks -(B Jl / k) jerk; a lagging drive gives J T jerk. None
// is negative: a torque that leads is one that was recorded late (transport_delay).
#include "components/model/effects/define.h"

namespace sinew::effects::elastic_joint {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Elastic joint with losses";
  info.formula = "- c * jerk";
  info.source =
      "third-order term of a damped elastic joint: c = B Jl / k, or J T of a lagging drive";
  info.linear = {Linear("flexibility", Dimension::kInertiaTime, {0.0, 100.0},
                        "torque per jerk; divided by the inertia a time")};
  info.signature = "residual follows jerk: torque that leads or lags the acceleration";
  info.confounders = {"transport_delay", "flexible_link", "gear_compliance"};
  info.separating_excitation = "fast reversals and pulses with two loads";
  info.needs = {"jerk_rad_s3"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x) { return -x.jerk_rad_s3; });
}

}  // namespace sinew::effects::elastic_joint
