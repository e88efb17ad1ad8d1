#include "tools/rerun/recorded_parts.h"

#include <algorithm>
#include <fstream>
#include <system_error>

#include "components/base/config/config.h"
#include "components/base/types/joined.h"

namespace sinew::rerun {
namespace {

namespace fs = std::filesystem;

// Place of a written attachment: its name below the folder, absolute names by their last parts.
fs::path PlaceOf(const std::string& name, const std::string& file) {
  fs::path place = fs::path(name).lexically_normal().relative_path();
  const bool leads_out =
      std::any_of(place.begin(), place.end(), [](const fs::path& part) { return part == ".."; });
  if (place.empty() || leads_out) {
    throw UsageError(file + ": attachment '" + name + "', expected the name of a file");
  }
  return place;
}

bool IsDeployment(const std::string& text) {
  return text.starts_with("schema: sinew-deployment/1") ||
         text.find("\nschema: sinew-deployment/1") != std::string::npos;
}

std::string NamesOf(const launch::Deployment& deployment) {
  return types::Joined(deployment.processes, ", ", &launch::Process::name);
}

bool CanRunAgain(const launch::Process& process) {
  const std::vector<std::string> programs = compose::ComposedPrograms();
  return std::find(programs.begin(), programs.end(), process.program.filename().string()) !=
         programs.end();
}

}  // namespace

fs::path UnpackDeployment(const recording::McapReader& reader, const std::string& file,
                          const fs::path& folder) {
  fs::path deployment;
  for (const recording::McapAttachment& attachment : reader.ReadAttachments()) {
    const fs::path place = folder / PlaceOf(attachment.name, file);
    std::error_code error;
    fs::create_directories(place.parent_path(), error);
    std::ofstream(place, std::ios::binary) << attachment.data;
    if (config::ReadFile(place, config::kLargestData) != attachment.data) {
      throw UsageError(place.string() + ": cannot be written");
    }
    if (!IsDeployment(attachment.data)) continue;
    if (!deployment.empty()) {
      throw UsageError(file + ": more than one deployment is attached, expected --deployment FILE");
    }
    deployment = place;
  }
  if (deployment.empty()) {
    throw UsageError(file + ": no deployment is attached, expected --deployment FILE");
  }
  return deployment;
}

std::vector<compose::Part> PartsOf(const launch::Deployment& deployment,
                                   const std::vector<std::string>& names) {
  std::vector<compose::Part> parts;
  for (const std::string& name : names) {
    if (deployment.Find(name) == nullptr) {
      throw UsageError(deployment.file.string() + ": no process '" + name +
                       "', expected one of: " + NamesOf(deployment));
    }
  }
  for (const launch::Process& process : deployment.processes) {
    const bool wanted =
        names.empty() || std::find(names.begin(), names.end(), process.name) != names.end();
    if (!wanted || (names.empty() && !CanRunAgain(process))) continue;
    if (!process.arguments.empty()) {
      throw UsageError(deployment.file.string() + ": process '" + process.name +
                       "' has arguments, expected a configuration file alone");
    }
    parts.push_back({process.name, process.program.filename().string(), process.config});
  }
  if (parts.empty()) {
    throw UsageError(deployment.file.string() + ": no process of it can run again");
  }
  return parts;
}

node::TimeMode ModeOf(const recording::McapReader& reader, const std::string& file,
                      std::optional<node::TimeMode> deployed) {
  for (const recording::McapMetadata& metadata : reader.ReadMetadata()) {
    if (metadata.name != "sinew.recording") continue;
    const auto mode = metadata.values.find("mode");
    if (mode == metadata.values.end()) continue;
    if (mode->second == "lockstep") return node::TimeMode::kLockstep;
    if (mode->second == "realtime") return node::TimeMode::kRealtime;
  }
  if (deployed) return *deployed;
  throw UsageError(file +
                   ": its metadata do not say the mode, expected a recording by sinew-logger");
}

}  // namespace sinew::rerun
