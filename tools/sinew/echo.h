// `sinew echo`: messages of a topic, decoded.
#pragma once

namespace CLI {
class App;
}

namespace sinew::tools {

void AddEchoCommand(CLI::App& app);

}  // namespace sinew::tools
