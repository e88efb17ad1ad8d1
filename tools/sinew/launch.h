// `sinew launch`: starts the processes of a deployment file; `sinew compose`: with the provider's
// chain as one process.
#pragma once

namespace CLI {
class App;
}

namespace sinew::tools {

void AddLaunchCommand(CLI::App& app);
void AddComposeCommand(CLI::App& app);

}  // namespace sinew::tools
