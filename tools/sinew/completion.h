// `sinew completion`: scripts that complete the command's words.
#pragma once

namespace CLI {
class App;
}

namespace sinew::tools {

void AddCompletionCommand(CLI::App& app);

}  // namespace sinew::tools
