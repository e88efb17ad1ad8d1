// sinew-residual as an object: publishes `residual`.
#pragma once

#include <filesystem>
#include <memory>

#include "components/topics/node/component.h"
#include "components/topics/node/options.h"

namespace sinew::residual {

// Throws UsageError (configuration), DdsError. `stop` outlives it.
std::unique_ptr<node::Component> MakeResidual(const node::Options& options, node::StopFlag& stop,
                                              const std::filesystem::path& model_path = {});

}  // namespace sinew::residual
