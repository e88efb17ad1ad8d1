// Flow in (or out) right after the valve was opened, as it was recorded.
#include "components/model/effects/define.h"

namespace sinew::effects::gas::valve_flow {

std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& constants) {
  info.title = "Flow through the open valve";
  info.formula = "- F(t - t_open), F: curve of each opening";
  info.source = "ISO 6358: a smooth function of the pressures; its curve is taken from the record";
  info.linear = {Linear("share", Dimension::kNone, {1.0 - 1e-9, 1.0 + 1e-9},
                        "1: the flow begins with the command and the stated delay", 1.0)};
  info.signature = "pressure moves once the valve is open";
  info.needs = {"valve_flow_bar"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x) { return -x.valve_flow_bar; });
}

}  // namespace sinew::effects::gas::valve_flow
