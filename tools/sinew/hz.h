// `sinew hz`: rate, jitter, age and loss of topics, live or of a recording.
#pragma once

namespace CLI {
class App;
}

namespace sinew::tools {

void AddHzCommand(CLI::App& app);

}  // namespace sinew::tools
