// Every subcommand of `sinew`, in the order of its help.
#pragma once

namespace CLI {
class App;
}

namespace sinew::tools {

void AddAllCommands(CLI::App& app);

}  // namespace sinew::tools
