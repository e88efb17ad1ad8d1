// Configuration files of a robot, changed for a trial.
#pragma once

#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <string>

namespace sinew::edited_yaml {

// Throws UsageError naming the file.
YAML::Node LoadYaml(const std::filesystem::path& path);

// Gives every entry `key`, at any depth, the value; how many there were. A node refers to its
// content, which changes.
int ReplaceEntries(const YAML::Node& node, const std::string& key, const YAML::Node& value);

// Scalars that name a file relative to `folder` name it by its absolute path, so that the text may
// stand elsewhere.
void MakePathsAbsolute(YAML::Node node, const std::filesystem::path& folder);

// With a newline at the end; numbers are read back to the same bits.
std::string YamlText(const YAML::Node& node);

}  // namespace sinew::edited_yaml
