// sinew-performance as an object: publishes `performance`.
#pragma once

#include <memory>

#include "components/topics/node/component.h"
#include "components/topics/node/options.h"

namespace sinew::performance {

// Throws UsageError (configuration), DdsError. `stop` outlives it.
std::unique_ptr<node::Component> MakePerformance(const node::Options& options,
                                                 node::StopFlag& stop);

}  // namespace sinew::performance
