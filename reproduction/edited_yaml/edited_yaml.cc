#include "reproduction/edited_yaml/edited_yaml.h"

#include <limits>

#include "components/config/config.h"

namespace sinew::reproduction {

YAML::Node LoadYaml(const std::filesystem::path& path) {
  try {
    return YAML::Load(config::ReadFile(path));
  } catch (const YAML::Exception& error) {
    throw UsageError(path.string() + ": " + error.what());
  }
}

std::string YamlText(const YAML::Node& node) {
  YAML::Emitter emitter;
  emitter.SetDoublePrecision(std::numeric_limits<double>::max_digits10);
  emitter << node;
  return std::string(emitter.c_str()) + "\n";
}

}  // namespace sinew::reproduction
