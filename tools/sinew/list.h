// `sinew list`: participants, topics and problems of a domain; or what is in a recording.
#pragma once

namespace CLI {
class App;
}

namespace sinew::tools {

void AddListCommand(CLI::App& app);

}  // namespace sinew::tools
