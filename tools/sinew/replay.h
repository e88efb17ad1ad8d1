// `sinew replay`: sends a recording into a domain, as sinew-player does.
#pragma once

namespace CLI {
class App;
}

namespace sinew::tools {

void AddReplayCommand(CLI::App& app);

}  // namespace sinew::tools
