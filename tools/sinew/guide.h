// Help to find a command: the list in groups, `sinew help`, and what a mistyped word may have
// meant. Set-up only.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace sinew::tools {

// After all commands were added.
void AddGuide(CLI::App& app);

// The command in use when parsing stopped: "sinew model show".
std::string CommandInUse(const CLI::App& app);

// Says what an argument that was not expected may have meant: "; did you mean 'list'?", or empty.
std::string Suggestion(const CLI::App& app);

}  // namespace sinew::tools
