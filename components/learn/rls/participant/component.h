// sinew-rls as an object: publishes `readout` and `adaptation_state`.
#pragma once

#include <memory>

#include "components/learn/rls/file/rls_config.h"
#include "components/topics/node/component.h"
#include "components/topics/node/options.h"

namespace sinew::rls {

// Throws UsageError (configuration), DdsError. `stop` outlives it.
std::unique_ptr<node::Component> MakeRls(const node::Options& options, node::StopFlag& stop,
                                         const esn::WeightsPaths& given = {});

}  // namespace sinew::rls
