// sinew-pneumatics as an object: publishes `valve_command` and `pneumatic_state`: holds pressures
// or stiffnesses.
#pragma once

#include <memory>

#include "components/topics/node/component.h"
#include "components/topics/node/options.h"

namespace sinew::pneumatics {

// Throws UsageError (configuration), DdsError. `stop` outlives it.
std::unique_ptr<node::Component> MakePneumatics(const node::Options& options, node::StopFlag& stop);

}  // namespace sinew::pneumatics
