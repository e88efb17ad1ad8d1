// `sinew tables MODULE`: what single modules reach on the surrogate, as tables of the page.
#pragma once

namespace CLI {
class App;
}

namespace sinew::reproduction {

void AddTablesCommand(CLI::App& app);

}  // namespace sinew::reproduction
