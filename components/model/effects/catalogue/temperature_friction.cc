#include "components/model/effects/define.h"

namespace sinew::effects::temperature_friction {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Friction that drifts with temperature";
  info.formula = "- (T - 25 degC) * (c * sign v + b * v)";
  info.source = "SKF: The SKF model for calculating the frictional moment; grease viscosity";
  info.linear = {Linear("coulomb", Dimension::kTorquePerKelvin, {-10.0, 10.0},
                        "Coulomb friction per kelvin above 25 degC"),
                 Linear("viscous", Dimension::kViscousPerKelvin, {-100.0, 100.0},
                        "viscous friction per kelvin above 25 degC")};
  info.signature = "friction that changes over the run with motor temperature";
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
