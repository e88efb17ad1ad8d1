// `sinew import`: CSV files and a mapping into one recording.
#pragma once

namespace CLI {
class App;
}

namespace sinew::tools {

void AddImportCommand(CLI::App& app);

}  // namespace sinew::tools
