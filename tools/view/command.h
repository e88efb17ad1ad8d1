// `sinew view`: starts sinew-view.
#pragma once

namespace CLI {
class App;
}

namespace sinew::live {

void AddViewCommand(CLI::App& app);

}  // namespace sinew::live
