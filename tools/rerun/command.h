// `sinew rerun`: components of a recording run again, and compared with it.
#pragma once

#include <CLI/CLI.hpp>

namespace sinew::rerun {

void AddRerunCommand(CLI::App& app);

}  // namespace sinew::rerun
