// `sinew compare`: the published tables of networks beside ours.
#pragma once

namespace CLI {
class App;
}

namespace sinew::reproduction {

void AddCompareCommand(CLI::App& app);

}  // namespace sinew::reproduction
