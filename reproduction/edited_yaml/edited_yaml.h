// Configuration files of a robot, changed for a trial.
#pragma once

#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <string>

namespace sinew::reproduction {

// Throws UsageError naming the file.
YAML::Node LoadYaml(const std::filesystem::path& path);

// With a newline at the end; numbers are read back to the same bits.
std::string YamlText(const YAML::Node& node);

}  // namespace sinew::reproduction
