// `sinew plot`: fields of recordings over time, in the terminal or as PNG and SVG files.
#pragma once

namespace CLI {
class App;
}

namespace sinew::tools {

void AddPlotCommand(CLI::App& app);

}  // namespace sinew::tools
