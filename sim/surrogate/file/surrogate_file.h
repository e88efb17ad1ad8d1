// Reads the surrogate's configuration, schema sinew-surrogate/1. Every key has a default (the rig),
// so an empty section is the rig itself. Throws UsageError. Not for loops.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "components/config/config.h"
#include "sim/surrogate/parameters.h"

namespace sinew::surrogate {

RigParameters ReadRig(const config::Section& section);
// An empty path gives the defaults.
RigParameters LoadRig(const std::filesystem::path& path);

// Effects named on the command line take the place of the file's. Throws UsageError.
std::vector<EffectSpec> ParseEffects(const std::vector<std::string>& texts);

}  // namespace sinew::surrogate
