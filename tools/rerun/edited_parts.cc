#include "tools/rerun/edited_parts.h"

#include "components/base/config/config.h"
#include "components/base/config/yaml_text.h"
#include "tools/edited_yaml/edited_yaml.h"

namespace sinew::rerun {
namespace {

namespace fs = std::filesystem;

YAML::Node ValueOf(const Edit& edit) {
  std::error_code ignored;
  if (fs::is_regular_file(edit.value, ignored))
    return YAML::Node(fs::absolute(edit.value).string());
  return config::ParseYaml(edit.value, "--with " + edit.key);
}

}  // namespace

Edit ParseEdit(const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::string path = text.substr(0, equals);
  const std::size_t dot = path.rfind('.');
  Edit edit;
  edit.key = dot == std::string::npos ? path : path.substr(dot + 1);
  if (dot != std::string::npos) edit.component = path.substr(0, dot);
  if (equals == std::string::npos || edit.key.empty() || dot == 0) {
    throw UsageError("--with " + text + ": expected KEY=VALUE or COMPONENT.KEY=VALUE");
  }
  edit.value = text.substr(equals + 1);
  return edit;
}

std::vector<compose::Part> EditParts(const std::vector<compose::Part>& parts,
                                     const std::vector<Edit>& edits, const fs::path& folder) {
  std::vector<compose::Part> edited;
  std::vector<int> changed(edits.size(), 0);
  std::vector<YAML::Node> values;
  values.reserve(edits.size());
  for (const Edit& edit : edits) values.push_back(ValueOf(edit));
  for (const compose::Part& part : parts) {
    if (part.config.empty()) continue;
    YAML::Node root = edited_yaml::LoadYaml(part.config);
    int count = 0;
    for (std::size_t i = 0; i < edits.size(); ++i) {
      const Edit& edit = edits[i];
      if (!edit.component.empty() && edit.component != part.name) continue;
      const int entries = edited_yaml::ReplaceEntries(root, edit.key, values[i]);
      changed[i] += entries;
      count += entries;
    }
    if (count == 0) continue;
    edited_yaml::MakePathsAbsolute(root, part.config.parent_path());
    compose::Part copy = part;
    copy.config = folder / (part.name + ".yaml");
    config::WriteFileAtomically(copy.config, edited_yaml::YamlText(root));
    edited.push_back(std::move(copy));
  }
  for (std::size_t i = 0; i < edits.size(); ++i) {
    if (changed[i] > 0) continue;
    const Edit& edit = edits[i];
    throw UsageError(edit.component.empty()
                         ? "--with " + edit.key +
                               ": no configuration has such an entry, expected "
                               "a key that is written there"
                         : "--with " + edit.component + "." + edit.key + ": '" + edit.component +
                               "' is not run again, or its configuration has no such entry");
  }
  return edited;
}

}  // namespace sinew::rerun
