// Gear friction that grows with the load: with the torque behind gear and friction, not with that
// of the drive, which is larger by the friction against the load and smaller with it.
#include "components/model/effects/define.h"

namespace sinew::effects::load_dependent_friction {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Gear friction that grows with the load";
  info.formula = "- share * |T| * sign v, T: drive torque N Kt I less the declared friction";
  info.source = "Dohring, Lee, Newman: A Load-Dependent Transmission Friction Model (1993)";
  info.linear = {
      RelativeToDrive(Linear("share", Dimension::kNone, {0.0, 1.0}, "friction per load torque"))};
  info.signature = "Coulomb step that grows with the load";
  info.confounders = {"drive_efficiency_direction", "coulomb"};
  info.separating_excitation = "the same slow motion with and against a known load";
  info.needs = {"drive_input", "velocity_rad_s"};
  return Memoryless(constants, std::move(info), [](const JointSample& x, const JointConstants& c) {
    return -std::abs(LoadTorque(x, c)) * Sign(x.velocity_rad_s);
  });
}

}  // namespace sinew::effects::load_dependent_friction
