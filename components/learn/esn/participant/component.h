// sinew-esn as an object: publishes `torque_prediction` and `reservoir_state`.
#pragma once

#include <memory>

#include "components/learn/esn/file/esn_config.h"
#include "components/topics/node/component.h"
#include "components/topics/node/options.h"

namespace sinew::esn {

// Throws UsageError (configuration), DdsError. `stop` outlives it.
std::unique_ptr<node::Component> MakeEsn(const node::Options& options, node::StopFlag& stop,
                                         const WeightsPaths& given = {});

}  // namespace sinew::esn
