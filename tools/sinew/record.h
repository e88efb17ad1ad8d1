// `sinew record`: records the topics of a domain, as sinew-logger does.
#pragma once

namespace CLI {
class App;
}

namespace sinew::tools {

void AddRecordCommand(CLI::App& app);

}  // namespace sinew::tools
