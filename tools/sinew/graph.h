// `sinew graph`: a picture of who speaks to whom, live or from a recording.
#pragma once

namespace CLI {
class App;
}

namespace sinew::tools {

void AddGraphCommand(CLI::App& app);

}  // namespace sinew::tools
