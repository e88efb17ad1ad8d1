// Reads the surrogate's configuration, schema sinew-surrogate/1. Every key has a default (the rig),
// so an empty section is the rig itself. Throws UsageError. Not for loops.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "components/base/config/fields.h"
#include "sim/surrogate/parameters.h"

namespace sinew::surrogate {

inline constexpr char kSchema[] = "sinew-surrogate/1";

// Every key but `guard`.
void Describe(config::Fields& f, RigParameters& c);

// The file, or an empty section for an empty path.
config::Section OpenSurrogate(const std::filesystem::path& path);
// The `guard` block of the same file is left to the state provider, which rejects its unknown keys.
RigParameters ReadRig(const config::Section& section);
// The same of a file.
RigParameters LoadRig(const std::filesystem::path& path);

// Effects named on the command line take the place of the file's. Throws UsageError.
std::vector<EffectSpec> ParseEffects(const std::vector<std::string>& texts);

// A line for each effect, for people.
std::string DescribeEffects();

}  // namespace sinew::surrogate
