#include "tools/edited_yaml/edited_yaml.h"

#include <limits>

#include "components/base/config/config.h"
#include "components/base/config/yaml_text.h"

namespace sinew::edited_yaml {

YAML::Node LoadYaml(const std::filesystem::path& path) {
  return config::ParseYaml(config::ReadFile(path), path.string());
}

int ReplaceEntries(const YAML::Node& node, const std::string& key, const YAML::Node& value) {
  int count = 0;
  if (node.IsMap()) {
    for (auto entry : node) {
      if (entry.first.as<std::string>() == key) {
        entry.second = value;
        ++count;
      } else {
        count += ReplaceEntries(entry.second, key, value);
      }
    }
  } else if (node.IsSequence()) {
    for (YAML::Node element : node) count += ReplaceEntries(element, key, value);
  }
  return count;
}

void MakePathsAbsolute(YAML::Node node, const std::filesystem::path& folder) {
  if (node.IsMap()) {
    for (auto entry : node) MakePathsAbsolute(entry.second, folder);
  } else if (node.IsSequence()) {
    for (YAML::Node element : node) MakePathsAbsolute(element, folder);
  } else if (node.IsScalar() && !node.Scalar().empty()) {
    const std::filesystem::path path = folder / node.Scalar();
    std::error_code ignored;
    if (std::filesystem::is_regular_file(path, ignored)) {
      node = std::filesystem::absolute(path).lexically_normal().string();
    }
  }
}

std::string YamlText(const YAML::Node& node) {
  YAML::Emitter emitter;
  emitter.SetDoublePrecision(std::numeric_limits<double>::max_digits10);
  emitter << node;
  return std::string(emitter.c_str()) + "\n";
}

}  // namespace sinew::edited_yaml
