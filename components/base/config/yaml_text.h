// Text as YAML, for everything that reads YAML of a user. Apart from config.h, which needs no
// header of yaml-cpp.
#pragma once

#include <yaml-cpp/yaml.h>

#include <cstddef>
#include <string>

namespace sinew::config {

// Values of a document with every alias replaced by what it stands for, which is what a reader
// visits. yaml-cpp keeps about 300 bytes of each: together below a third of a gigabyte.
inline constexpr std::size_t kMostYamlNodes = std::size_t{1} << 20;
// Sequences and maps inside each other, aliases replaced: what yaml-cpp's parser allows without
// them. Readers visit them by recursion.
inline constexpr std::size_t kMostYamlLevels = 500;

// Throws UsageError, "NAME:LINE: ...", for what is no YAML, a key that is given twice at any depth
// or has no value (null among them), a second document, an alias inside of what it stands for, and
// for more than kMostYamlNodes values. yaml-cpp bounds the depth itself (500).
YAML::Node ParseYaml(const std::string& text, const std::string& name);

}  // namespace sinew::config
