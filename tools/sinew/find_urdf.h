// The URDF of a model file's robot.
#pragma once

#include <filesystem>

#include "tools/sinew/close_loop.h"

namespace sinew::tools {

// As the options name it, else as the model file does: beside the model file, else from where the
// command runs. Throws UsageError.
std::filesystem::path FindUrdf(const CloseLoopOptions& options, const LoopInput& input);

}  // namespace sinew::tools
