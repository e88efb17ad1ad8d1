// `sinew performance`: tracking errors and energies of a recording.
#pragma once

namespace CLI {
class App;
}

namespace sinew::tools {

void AddPerformanceCommand(CLI::App& app);

}  // namespace sinew::tools
