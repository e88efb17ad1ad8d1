// `sinew launch`: starts the processes of a deployment file.
#pragma once

namespace CLI {
class App;
}

namespace sinew::tools {

void AddLaunchCommand(CLI::App& app);

}  // namespace sinew::tools
