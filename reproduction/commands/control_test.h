// `sinew control-test`: the strategies of Figs 7.2 and 7.3 over DDS on the surrogate.
#pragma once

namespace CLI {
class App;
}

namespace sinew::reproduction {

void AddControlTestCommand(CLI::App& app);

}  // namespace sinew::reproduction
