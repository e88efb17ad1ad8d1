// `sinew tune`: PID gains and pressures of a robot, found in simulation.
#pragma once

#include <CLI/CLI.hpp>

namespace sinew::tune {

void AddTuneCommand(CLI::App& app);

}  // namespace sinew::tune
