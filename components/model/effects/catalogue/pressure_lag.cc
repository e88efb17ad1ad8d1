// Pressure sensor that lags.
#include "components/model/effects/define.h"

namespace sinew::effects::pressure_lag {

std::unique_ptr<Effect> Make(const JointConstants& constants) {
  EffectInfo info;
  info.name = "pressure_lag";
  info.title = "Pressure sensor that lags";
  info.formula = "+ c * dP/dt, c = K * lag";
  info.source = "first order of P(t + lag)";
  info.linear = {{.name = "lag",
                  .dimension = Dimension::kTorqueTimePerBar,
                  .lower = -10.0,
                  .upper = 10.0,
                  .default_value = 0.0,
                  .meaning = "pneumatic torque per bar times the lag of the sensor"}};
  info.signature = "residual follows the rate of pressure";
  info.variable = "pressure_rate_bar_s";
  info.confounders = {"viscous"};
  info.separating_excitation = "pressure steps at rest";
  info.needs = {"pressure_rate_bar_s"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants&, std::span<const double>,
                       std::span<double> phi) { phi[0] = x.pressure_rate_bar_s; });
}

}  // namespace sinew::effects::pressure_lag
