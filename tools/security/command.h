// `sinew security`: keys and certificates of a deployment.
#pragma once

namespace CLI {
class App;
}

namespace sinew::security {

void AddSecurityCommand(CLI::App& app);

}  // namespace sinew::security
