// `sinew arm`, `disarm`, `estop`, `reset`: the operator's word.
#pragma once

namespace CLI {
class App;
}

namespace sinew::tools {

void AddOperatorCommands(CLI::App& app);

}  // namespace sinew::tools
