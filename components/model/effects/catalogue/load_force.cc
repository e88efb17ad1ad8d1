// Force on the load cell, positive presses the link down; on a linear joint against +position, with
// the lever 1.
#include "components/model/effects/define.h"

namespace sinew::effects::load_force {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Measured load force";
  info.formula = "- share * F * l";
  info.source = "thesis (5.3)";
  info.linear = {Linear("share", Dimension::kNone, {0.5, 1.5},
                        "1: the load cell reads right; fixed in model files", 1.0)};
  info.signature = "residual follows the load cell";
  info.confounders = {"payload"};
  info.separating_excitation = "pushes of known force";
  info.needs = {"load_force_N"};
  return Memoryless(constants, std::move(info), [](const JointSample& x, const JointConstants& c) {
    return -x.load_force_N * c.link_length_m;
  });
}

}  // namespace sinew::effects::load_force
