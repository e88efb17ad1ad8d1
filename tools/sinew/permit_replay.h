// `sinew permit-replay NAME`: the recording that NAME plays may move live hardware.
#pragma once

namespace CLI {
class App;
}

namespace sinew::tools {

void AddPermitReplayCommand(CLI::App& app);

}  // namespace sinew::tools
