#include "components/model/effects/define.h"

namespace sinew::effects::drive_efficiency_direction {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Efficiency that depends on the direction of power";
  info.formula =
      "+ gain * T while the load drives the motor, else 0; T: drive torque N Kt I less the "
      "declared friction";
  info.source =
      "Giberti, Cinquemani, Legnani: Effects of transmission mechanical characteristics on the "
      "choice of a motor-reducer (2010)";
  info.linear = {RelativeToDrive(Linear("gain", Dimension::kNone, {-1.0, 1.0},
                                        "backward drive factor minus forward drive factor"))};
  info.signature = "drive torque scaled by another factor when power flows back";
  info.confounders = {"load_dependent_friction"};
  info.separating_excitation = "lowering and lifting the same load at the same speed";
  info.needs = {"drive_input", "velocity_rad_s"};
  return Memoryless(constants, std::move(info), [](const JointSample& x, const JointConstants& c) {
    const double load = LoadTorque(x, c);
    const double s = Sign(load * x.velocity_rad_s);
    return 0.5 * (std::abs(s) - s) * load;
  });
}

}  // namespace sinew::effects::drive_efficiency_direction
