// `sinew experiment`: the rig's experiments, on the surrogate in process or over topics.
#pragma once

namespace CLI {
class App;
}

namespace sinew::tools {

void AddExperimentCommand(CLI::App& app);

}  // namespace sinew::tools
