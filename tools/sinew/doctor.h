// `sinew doctor`: what is wrong with host, shared memory, participants and CAN, with advice.
#pragma once

namespace CLI {
class App;
}

namespace sinew::tools {

void AddDoctorCommand(CLI::App& app);

}  // namespace sinew::tools
