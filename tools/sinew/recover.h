// `sinew recover`: a whole recording out of one that was cut off.
#pragma once

namespace CLI {
class App;
}

namespace sinew::tools {

void AddRecoverCommand(CLI::App& app);

}  // namespace sinew::tools
