// `sinew experiment`: the rig's experiments, over topics, from a recording, or on a simulation in
// this process where there is one.
#pragma once

#include <memory>

namespace CLI {
class App;
}

namespace sinew::tools {

class ExperimentSimulation;

// simulation: null where none is built; the command then asks for --dds or --recording.
void AddExperimentCommand(CLI::App& app,
                          const std::shared_ptr<ExperimentSimulation>& simulation = nullptr);

}  // namespace sinew::tools
