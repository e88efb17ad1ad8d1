// `sinew check MODULE`: what a module must reach, measured on the surrogate.
#pragma once

namespace CLI {
class App;
}

namespace sinew::tools {

void AddCheckCommand(CLI::App& app);

}  // namespace sinew::tools
