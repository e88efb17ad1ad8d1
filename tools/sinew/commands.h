// The commands of `sinew`.
//
// AddAllCommands is written by CMake: it calls every function that sinew_add_commands
// (cmake/SinewModules.cmake) registered, AddCoreCommands first.
#pragma once

namespace CLI {
class App;
}

namespace sinew::tools {

void AddAllCommands(CLI::App& app);
// Those that are there in every build.
void AddCoreCommands(CLI::App& app);

}  // namespace sinew::tools
