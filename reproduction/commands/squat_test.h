// `sinew squat-test`: control strategies on the biped.
#pragma once

namespace CLI {
class App;
}

namespace sinew::reproduction {

void AddSquatTestCommand(CLI::App& app);

}  // namespace sinew::reproduction
