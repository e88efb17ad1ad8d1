// Flow in (or out) right after the valve was opened, as it was recorded.
#include "components/model/effects/define.h"

namespace sinew::effects::gas::valve_flow {

std::unique_ptr<Effect> Make(const JointConstants& constants) {
  EffectInfo info;
  info.name = "valve_flow";
  info.title = "Flow through the open valve";
  info.formula = "- F(t - t_open), F: curve of each opening";
  info.source = "ISO 6358: a smooth function of the pressures; its curve is taken from the record";
  info.balance = Balance::kGas;
  info.linear = {{.name = "share",
                  .dimension = Dimension::kNone,
                  .lower = 1.0 - 1e-9,
                  .upper = 1.0 + 1e-9,
                  .default_value = 1.0,
                  .meaning = "1: the flow begins with the command and the stated delay"}};
  info.signature = "pressure moves once the valve is open";
  info.variable = "valve_flow_bar";
  info.needs = {"valve_flow_bar"};
  return Memoryless(constants, std::move(info),
                    [](const JointSample& x, const JointConstants&, std::span<const double>,
                       std::span<double> phi) { phi[0] = -x.valve_flow_bar; });
}

}  // namespace sinew::effects::gas::valve_flow
