// `sinew conform ROLE PROGRAM`: the contract test of a program that takes a role.
#pragma once

namespace CLI {
class App;
}

namespace sinew::tools {

void AddConformCommand(CLI::App& app);

}  // namespace sinew::tools
