// `sinew export`: a recording for other programs.
#pragma once

namespace CLI {
class App;
}

namespace sinew::export_recording {

void AddExportCommand(CLI::App& app);

}  // namespace sinew::export_recording
