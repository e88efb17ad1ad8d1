// sinew-control as an object: publishes `joint_command`.
#pragma once

#include <filesystem>
#include <memory>

#include "components/topics/node/component.h"
#include "components/topics/node/options.h"

namespace sinew::control {

// Throws UsageError (configuration), DdsError. `stop` outlives it.
std::unique_ptr<node::Component> MakeControl(const node::Options& options, node::StopFlag& stop,
                                             const std::filesystem::path& model_path = {});

}  // namespace sinew::control
