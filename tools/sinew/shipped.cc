#include "tools/sinew/shipped.h"

#include "components/base/config/config.h"
#include "components/base/config/program_file.h"

namespace sinew::tools {

namespace fs = std::filesystem;

fs::path ShippedFolder(const fs::path& wanted) {
  std::error_code error;
  for (fs::path folder = config::ProgramFile().parent_path(); folder.has_relative_path();
       folder = folder.parent_path()) {
    for (const fs::path& candidate : {folder / "share" / "sinew" / wanted, folder / wanted}) {
      if (fs::is_directory(candidate, error)) return candidate;
    }
  }
  return {};
}

// Found by the rig's: a build tree mirrors the source and has empty folders of the same names.
fs::path RobotsFolder() { return ShippedFolder("robots/rig").parent_path(); }

fs::path ShippedRobotFile(const fs::path& file) {
  const fs::path folder = RobotsFolder();
  std::error_code error;
  if (!folder.empty() && fs::exists(folder / file, error)) return folder / file;
  throw UsageError("robots/" + file.string() +
                   ": not found beside the program, expected the file's path");
}

fs::path DefaultCsvMap(const fs::path& model) {
  const fs::path beside = model.parent_path() / "csv_map.yaml";
  return fs::exists(beside) ? beside : ShippedRobotFile("rig/csv_map.yaml");
}

}  // namespace sinew::tools
