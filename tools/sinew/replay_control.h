// `sinew replay-control`: pauses, steps, moves a running player of this host.
#pragma once

namespace CLI {
class App;
}

namespace sinew::tools {

void AddReplayControlCommand(CLI::App& app);

}  // namespace sinew::tools
