// `sinew search`: the reservoir's hyper-parameters over a grid or drawn at random.
#pragma once

namespace CLI {
class App;
}

namespace sinew::reproduction {

void AddSearchCommand(CLI::App& app);

}  // namespace sinew::reproduction
