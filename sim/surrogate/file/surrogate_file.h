// Reads the surrogate's configuration, schema sinew-surrogate/1. Every key has a default (the rig),
// so an empty section is the rig itself. Throws UsageError. Not for loops.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "components/base/config/config.h"
#include "sim/surrogate/parameters.h"

namespace sinew::surrogate {

// The file, or an empty section for an empty path.
config::Section OpenSurrogate(const std::filesystem::path& path);
// Does not reject what it does not know: the same file has the state provider's `guard` block, so
// the caller calls RejectUnknownKeys when both were read.
RigParameters ReadRig(const config::Section& section);
// For programs without a guard: reads the rig and rejects unknown keys, those of the guard
// excepted.
RigParameters LoadRig(const std::filesystem::path& path);

// Effects named on the command line take the place of the file's. Throws UsageError.
std::vector<EffectSpec> ParseEffects(const std::vector<std::string>& texts);

// A line for each effect, for people.
std::string DescribeEffects();

}  // namespace sinew::surrogate
