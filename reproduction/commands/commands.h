// The commands of `sinew` that regenerate published tables.
#pragma once

namespace CLI {
class App;
}

namespace sinew::reproduction {

// Adds compare, search, control-test, tables and paper to the program, and the surrogate in this
// process to its command experiment, which must be there.
void AddCommands(CLI::App& app);

}  // namespace sinew::reproduction
