// A plain spring: rubber, a torsion bar, a cable.
#include "components/model/effects/define.h"

namespace sinew::effects::spring {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Plain spring";
  info.formula = "- k * q + T0, T0 = k * q0";
  info.source = "Hooke";
  info.linear = {
      Linear("stiffness", Dimension::kStiffness, {0.0, 1e6}, "k, restoring torque per angle"),
      Linear("preload", Dimension::kTorque, {-1e4, 1e4},
             "torque at position 0; the spring rests at q0 = preload / k")};
  info.signature = "residual falls in a line over the position";
  info.confounders = {"gravity", "gravity_phase", "pneumatic_stiffness", "offset"};
  info.separating_excitation = "slow motion over the whole range; several pressures";
  info.needs = {"position_rad"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants&, std::span<const double>,
                       std::span<double> phi) {
                      phi[0] = -x.position_rad;
                      phi[1] = 1.0 + 0.0 * x.position_rad;
                    });
}

}  // namespace sinew::effects::spring
