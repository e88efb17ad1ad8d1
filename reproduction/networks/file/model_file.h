// Files of trained models: JSON, schema sinew-network/1, described in
// reproduction/docs/network-training.md.
//
// Numbers are written so that reading them gives the same bits.
#pragma once

#include <filesystem>
#include <string>

#include "reproduction/networks/model.h"

namespace sinew::networks {

// Throws UsageError, one line with the file, the key and what was expected.
Model LoadModel(const std::filesystem::path& path);
Model ParseModel(const std::string& text, const std::string& name);

std::string FormatModel(const Model& model);
// As a whole or not at all. Throws UsageError naming the path; std::invalid_argument as
// Model::Check().
void SaveModel(const std::filesystem::path& path, const Model& model);

}  // namespace sinew::networks
