// The surrogate as a state provider: for its own program and for compositions.
#pragma once

#include <string>
#include <vector>

#include "components/robot/provider/participant/provider_options.h"
#include "components/topics/node/options.h"

namespace sinew::surrogate {

// effects: undeclared ones, NAME, NAME=SIZE or NAME=SIZE@SECONDS; they take the place of the
// configuration's. Returns when the session ends. Throws UsageError and what RunProvider throws.
void RunSurrogate(const node::Options& options, node::StopFlag& stop,
                  const provider::ProviderOptions& provider_options,
                  const std::vector<std::string>& effects);

}  // namespace sinew::surrogate
