// `sinew rerun`: components of a recording run again, and compared with it. `sinew snapshot`: asks
// components for their state, for a recorder.
#pragma once

#include <CLI/CLI.hpp>

namespace sinew::rerun {

void AddRerunCommand(CLI::App& app);
void AddSnapshotCommand(CLI::App& app);

}  // namespace sinew::rerun
