// `sinew handover`: a role goes from the participant that has it to another one that stands by.
#pragma once

namespace CLI {
class App;
}

namespace sinew::tools {

void AddHandoverCommand(CLI::App& app);

}  // namespace sinew::tools
