// Pressure sensor that lags.
#include "components/model/effects/define.h"

namespace sinew::effects::pressure_lag {

std::unique_ptr<Effect> Make(const JointConstants& constants) {
  EffectInfo info;
  info.name = "pressure_lag";
  info.title = "Pressure sensor that lags";
  info.formula = "+ lag * dP/dt * (K - k1 (q - q0))";
  info.source = "first order of K P(t + lag) - k1 P(t + lag) (q - q0)";
  info.linear = {{.name = "lag",
                  .dimension = Dimension::kTime,
                  .lower = 0.0,
                  .upper = 2.0,
                  .default_value = 0.0,
                  .meaning = "how late the sensor reads"}};
  info.signature = "residual follows the rate of pressure";
  info.variable = "pressure_rate_bar_s";
  info.confounders = {"viscous"};
  info.separating_excitation = "pressure steps at rest";
  info.needs = {"pressure_rate_bar_s", "position_rad"};
  info.needs_pneumatics = true;
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants& c, std::span<const double>,
                       std::span<double> phi) {
                      phi[0] = x.pressure_rate_bar_s * TorquePerBar(c, x.position_rad);
                    });
}

}  // namespace sinew::effects::pressure_lag
