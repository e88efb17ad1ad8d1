// `sinew arm`, `disarm`, `estop`, `reset`: commands of the operator.
#pragma once

namespace CLI {
class App;
}

namespace sinew::tools {

void AddOperatorCommands(CLI::App& app);

}  // namespace sinew::tools
