// `sinew model`: model files.
#pragma once

namespace CLI {
class App;
}

namespace sinew::tools {

void AddModelCommand(CLI::App& app);

}  // namespace sinew::tools
