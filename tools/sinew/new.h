// sinew new bench: the files of a bench of one's own.
#pragma once

namespace CLI {
class App;
}

namespace sinew::tools {

void AddNewCommand(CLI::App& app);

}  // namespace sinew::tools
