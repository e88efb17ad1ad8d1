// Force on the load cell, positive presses the link down; on a linear joint against +position, with
// the lever 1.
#include "components/model/effects/define.h"

namespace sinew::effects::load_force {

std::unique_ptr<Effect> Make(const JointConstants& constants) {
  EffectInfo info;
  info.name = "load_force";
  info.title = "Measured load force";
  info.formula = "- share * F * l";
  info.source = "thesis (5.3)";
  info.linear = {{.name = "share",
                  .dimension = Dimension::kNone,
                  .lower = 0.5,
                  .upper = 1.5,
                  .default_value = 1.0,
                  .meaning = "1: the load cell reads right; fixed in model files"}};
  info.signature = "residual follows the load cell";
  info.variable = "load_force_N";
  info.confounders = {"payload"};
  info.separating_excitation = "pushes of known force";
  info.needs = {"load_force_N"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants& c, std::span<const double>,
                       std::span<double> phi) { phi[0] = -x.load_force_N * c.link_length_m; });
}

}  // namespace sinew::effects::load_force
