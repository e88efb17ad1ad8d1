// `sinew check-data`: checks of recordings before a fit.
#pragma once

namespace CLI {
class App;
}

namespace sinew::tools {

void AddCheckDataCommand(CLI::App& app);

}  // namespace sinew::tools
