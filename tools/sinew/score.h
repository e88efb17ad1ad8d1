// `sinew score`: errors of a recording.
#pragma once

namespace CLI {
class App;
}

namespace sinew::tools {

void AddScoreCommand(CLI::App& app);

}  // namespace sinew::tools
