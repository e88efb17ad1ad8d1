// sinew-regime as an object: publishes `regime`, inside the backlash or outside.
#pragma once

#include <memory>

#include "components/topics/node/component.h"
#include "components/topics/node/options.h"

namespace sinew::regime {

// Throws UsageError (configuration), DdsError. `stop` outlives it.
std::unique_ptr<node::Component> MakeRegime(const node::Options& options, node::StopFlag& stop);

}  // namespace sinew::regime
