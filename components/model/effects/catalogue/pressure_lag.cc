#include "components/model/effects/define.h"

namespace sinew::effects::pressure_lag {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Pressure sensor that lags";
  info.formula = "+ lag * dP/dt * (K - k1 (q - q0))";
  info.source = "first order of K P(t + lag) - k1 P(t + lag) (q - q0)";
  info.linear = {Linear("lag", Dimension::kTime, {0.0, 2.0}, "how late the sensor reads")};
  info.signature = "residual follows the rate of pressure";
  info.confounders = {"viscous"};
  info.separating_excitation = "pressure steps at rest";
  info.needs = {"pressure_rate_bar_s", "position_rad"};
  info.needs_pneumatics = true;
  return Memoryless(constants, std::move(info), [](const JointSample& x, const JointConstants& c) {
    return x.pressure_rate_bar_s * TorquePerBar(c, x.position_rad);
  });
}

}  // namespace sinew::effects::pressure_lag
