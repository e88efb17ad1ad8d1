// `sinew check-data`: are recordings fit to be assessed by a model?
#pragma once

namespace CLI {
class App;
}

namespace sinew::tools {

void AddCheckDataCommand(CLI::App& app);

}  // namespace sinew::tools
