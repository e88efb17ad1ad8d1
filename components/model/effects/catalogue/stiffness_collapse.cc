// Pneumatic element that loses its torque at low pressure: the vane's seals and the hose fold, part
// of the volume is not filled, and what is left pulls less than K P - k1 P (q - q0) says.
#include "components/model/effects/define.h"

namespace sinew::effects::stiffness_collapse {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Pneumatic torque that collapses at low pressure";
  info.formula = "- share * exp(-P / P0) * (K P - k1 P (q - q0))";
  info.source = "K P - k1 P (q - q0) with a share lost below P0";
  info.linear = {Linear("share", Dimension::kNone, {0.0, 2.0},
                        "of the torque, lost where the chamber is nearly empty")};
  info.nonlinear = {
      Nonlinear("pressure", Dimension::kPressure, {0.05, 10.0}, 0.8, {0.3, 0.6, 1.0, 1.6}, "P0")};
  info.signature = "residual at low pressure that turns its sign with the angle";
  info.confounders = {"pneumatic_stiffness", "pressure_offset", "pressure_gain"};
  info.separating_excitation = "the same angles at pressures from the vented chamber up";
  info.needs = {"pressure_bar", "position_rad"};
  info.needs_pneumatics = true;
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants& c, std::span<const double> psi) {
                      return -x.pressure_bar * std::exp(-x.pressure_bar / psi[0]) *
                             TorquePerBar(c, x.position_rad);
                    });
}

}  // namespace sinew::effects::stiffness_collapse
