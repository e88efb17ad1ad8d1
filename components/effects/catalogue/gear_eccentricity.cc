// Eccentric gear.
#include "components/effects/define.h"

namespace sinew::effects::gear_eccentricity {

std::unique_ptr<Effect> Make(const JointConstants& constants) {
  EffectInfo info;
  info.name = "gear_eccentricity";
  info.title = "Eccentric gear";
  info.formula = "+ a * sin(n q) + b * cos(n q)";
  info.rotary_only = true;
  info.source = "Smith: Gear Noise and Vibration";
  info.linear = {{.name = "sine",
                  .dimension = Dimension::kTorque,
                  .lower = -100.0,
                  .upper = 100.0,
                  .default_value = 0.0,
                  .meaning = "amplitude of the sine"},
                 {.name = "cosine",
                  .dimension = Dimension::kTorque,
                  .lower = -100.0,
                  .upper = 100.0,
                  .default_value = 0.0,
                  .meaning = "amplitude of the cosine"}};
  info.nonlinear = {{.name = "order",
                     .dimension = Dimension::kNone,
                     .lower = 0.5,
                     .upper = 12.0,
                     .default_value = 2.0,
                     .grid = {1, 2},
                     .meaning = "periods per output turn"}};
  info.signature = "residual periodic in output angle";
  info.variable = "position_rad";
  info.look_alikes = {"gravity", "gravity_phase", "cogging"};
  info.separating_excitation = "slow constant speed over the whole angle range";
  info.needs = {"position_rad"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants&, std::span<const double> psi,
                       std::span<double> phi) {
                      const double angle = psi[0] * x.position_rad;
                      phi[0] = std::sin(angle);
                      phi[1] = std::cos(angle);
                    });
}

}  // namespace sinew::effects::gear_eccentricity
