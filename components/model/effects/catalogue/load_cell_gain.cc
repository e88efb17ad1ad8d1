// Load cell that reads too much or too little.
#include "components/model/effects/define.h"

namespace sinew::effects::load_cell_gain {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Load cell that reads wrong";
  info.formula = "- gain * F * l";
  info.source = "sensor calibration put into - F l";
  // Wrong by more than half, it is another sensor or drive.
  info.linear = {
      Linear("gain", Dimension::kNone, {-0.5, 0.5}, "true force over indicated force, minus 1")};
  info.signature = "residual follows the load cell";
  info.confounders = {"load_force", "load_cell_misalignment", "torque_constant_gain"};
  info.separating_excitation = "a known weight on the load cell, with and without declared payload";
  info.needs = {"load_force_N"};
  return Memoryless(constants, std::move(info), [](const JointSample& x, const JointConstants& c) {
    return -x.load_force_N * c.link_length_m;
  });
}

}  // namespace sinew::effects::load_cell_gain
