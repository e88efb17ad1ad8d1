// `sinew close-loop`: which effect a model lacks, from recordings (components/model/close_loop).
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace sinew::tools {

// Values of --accept-fault, here and in check-data.
std::vector<std::string> FaultNames();
// When, where and by which command a page is made, for its end.
std::string Made();

void AddCloseLoopCommand(CLI::App& app);

}  // namespace sinew::tools
