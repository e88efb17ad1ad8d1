// `sinew paper`: regenerates the tables and figures of a paper on one page.
#pragma once

namespace CLI {
class App;
}

namespace sinew::reproduction {

void AddPaperCommand(CLI::App& app);

}  // namespace sinew::reproduction
