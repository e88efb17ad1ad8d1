// `sinew train`: a network from recordings of the robot.
#pragma once

namespace CLI {
class App;
}

namespace sinew::tools {

void AddTrainCommand(CLI::App& app);

}  // namespace sinew::tools
