// The surrogate in this process as the rig of `sinew experiment`: many trials, many specimens, and
// the true values beside the identified ones.
#pragma once

#include <memory>

#include "tools/sinew/experiment_run.h"

namespace sinew::reproduction {

// Adds --surrogate, --seeds, --spread and --threads to the command.
std::shared_ptr<tools::ExperimentSimulation> MakeSurrogateExperiments();

}  // namespace sinew::reproduction
