// sinew-reference as an object: publishes `reference`, where the joints should be.
#pragma once

#include <memory>

#include "components/topics/node/component.h"
#include "components/topics/node/options.h"

namespace sinew::reference {

// Throws UsageError (configuration), DdsError. `stop` outlives it.
std::unique_ptr<node::Component> MakeReference(const node::Options& options, node::StopFlag& stop);

}  // namespace sinew::reference
