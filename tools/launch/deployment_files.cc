#include "tools/launch/deployment_files.h"

#include <algorithm>
#include <set>

#include "components/base/config/config.h"
#include "components/base/config/yaml_text.h"

namespace sinew::launch {

namespace {

namespace fs = std::filesystem;

void CollectTexts(const YAML::Node& node, std::vector<std::string>* texts) {
  if (node.IsScalar()) texts->push_back(node.Scalar());
  if (node.IsSequence()) {
    for (const YAML::Node& item : node) CollectTexts(item, texts);
  }
  if (node.IsMap()) {
    for (const auto& entry : node) CollectTexts(entry.second, texts);
  }
}

std::vector<std::string> TextsOfYaml(const fs::path& file) {
  std::vector<std::string> texts;
  if (file.extension() != ".yaml" && file.extension() != ".yml") return texts;
  try {
    CollectTexts(config::ParseYaml(config::ReadFile(file), file.string()), &texts);
  } catch (const UsageError&) {  // the process that reads it as configuration reports it
  }
  return texts;
}

class FileList {
 public:
  explicit FileList(fs::path folder) : folder_(std::move(folder)) {}

  // Leaves this file out, whatever names it.
  void Leave(const fs::path& file) {
    std::error_code error;
    paths_.insert(fs::weakly_canonical(file, error));
  }
  void Add(const fs::path& file) {
    std::error_code error;
    const fs::path path = fs::weakly_canonical(file, error);
    // A text like "rig" may be the name of anything; one with a suffix is meant as a file.
    if (error || !path.has_extension() || path.extension() == ".mcap" ||
        path.extension() == ".key" || !fs::is_regular_file(path, error) ||
        !paths_.insert(path).second) {
      return;
    }
    files_.push_back({NameOf(path), path});
    for (const std::string& text : TextsOfYaml(path)) {
      if (!text.empty()) Add(path.parent_path() / text);
    }
  }
  std::vector<DeploymentFile> Take() { return std::move(files_); }

 private:
  std::string NameOf(const fs::path& path) {
    std::string name = path.lexically_relative(folder_).generic_string();
    if (name.empty() || name.starts_with("..")) name = path.filename().string();
    const std::string first = name;
    for (int number = 2; !names_.insert(name).second; ++number) {
      name = std::to_string(number) + "_" + first;
    }
    return name;
  }

  const fs::path folder_;
  std::set<fs::path> paths_;
  std::set<std::string> names_;
  std::vector<DeploymentFile> files_;
};

}  // namespace

std::vector<DeploymentFile> FilesOf(const Deployment& deployment) {
  std::error_code error;
  FileList list(fs::weakly_canonical(deployment.file, error).parent_path());
  list.Leave(deployment.key);  // whoever gets the recording does not get the robot
  list.Add(deployment.file);
  for (const Process& process : deployment.processes) {
    if (!process.config.empty()) list.Add(process.config);
    for (const std::string& argument : process.arguments) {
      if (!argument.empty()) list.Add(fs::absolute(argument, error));
    }
  }
  for (const Process& process : deployment.elsewhere) {
    if (!process.config.empty()) list.Add(process.config);
  }
  return list.Take();
}

}  // namespace sinew::launch
