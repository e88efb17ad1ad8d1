// Friction that drifts with temperature.
#include "components/model/effects/define.h"

namespace sinew::effects::temperature_friction {

std::unique_ptr<Effect> Make(const JointConstants& constants) {
  EffectInfo info;
  info.name = "temperature_friction";
  info.title = "Friction that drifts with temperature";
  info.formula = "- (T - 25 degC) * (c * sign v + b * v)";
  info.source = "SKF: The SKF model for calculating the frictional moment; grease viscosity";
  info.linear = {{.name = "coulomb",
                  .dimension = Dimension::kTorquePerKelvin,
                  .lower = -10.0,
                  .upper = 10.0,
                  .default_value = 0.0,
                  .meaning = "Coulomb friction per kelvin above 25 degC"},
                 {.name = "viscous",
                  .dimension = Dimension::kViscousPerKelvin,
                  .lower = -100.0,
                  .upper = 100.0,
                  .default_value = 0.0,
                  .meaning = "viscous friction per kelvin above 25 degC"}};
  info.signature = "friction that changes over the run with motor temperature";
  info.variable = "temperature_degC";
  info.confounders = {"coulomb", "viscous"};
  info.separating_excitation = "the same motion cold and warm";
  info.needs = {"temperature_degC", "velocity_rad_s"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants&, std::span<const double>,
                       std::span<double> phi) {
                      const double warm = x.temperature_degC - 25.0;
                      phi[0] = -warm * Sign(x.velocity_rad_s);
                      phi[1] = -warm * x.velocity_rad_s;
                    });
}

}  // namespace sinew::effects::temperature_friction
