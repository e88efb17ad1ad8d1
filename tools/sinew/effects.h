// `sinew effects`: the catalogue of effects.
#pragma once

namespace CLI {
class App;
}

namespace sinew::tools {

void AddEffectsCommand(CLI::App& app);

}  // namespace sinew::tools
