// `sinew verify`: a corrected model in world and control, beside the one before.
#pragma once

namespace CLI {
class App;
}

namespace sinew::tools {

void AddVerifyCommand(CLI::App& app);

}  // namespace sinew::tools
