// `sinew snapshot`: asks components for their state, for a recorder.
#pragma once

#include <CLI/CLI.hpp>

namespace sinew::rerun {

void AddSnapshotCommand(CLI::App& app);

}  // namespace sinew::rerun
