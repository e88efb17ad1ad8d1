// Weights files of echo state networks: JSON, schema sinew-esn/1, described in docs/formats_esn.md.
//
// Numbers are written so that reading them gives the same bits.
#pragma once

#include <filesystem>
#include <string>

#include "components/learn/esn/weights.h"

namespace sinew::esn {

// Throws UsageError, one line with the file, the key and what was expected: file absent, no JSON
// (with its line), a key missing or unknown, a shape that does not fit, a number that is not
// finite.
Weights LoadWeights(const std::filesystem::path& path);

// The same for text that is already here; `name` stands for the file.
Weights ParseWeights(const std::string& text, const std::string& name);

std::string FormatWeights(const Weights& weights);

// As a whole or not at all. Throws UsageError naming the path; std::invalid_argument as
// Weights::Check().
void SaveWeights(const std::filesystem::path& path, const Weights& weights);

}  // namespace sinew::esn
