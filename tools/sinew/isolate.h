// `sinew isolate`: holds the network of a deployment. `sinew enter`: runs a program in it.
#pragma once

namespace CLI {
class App;
}

namespace sinew::tools {

void AddIsolateCommands(CLI::App& app);

}  // namespace sinew::tools
