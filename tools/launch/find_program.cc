#include "tools/launch/find_program.h"

#include <unistd.h>

#include <cstdlib>
#include <sstream>
#include <system_error>

#include "components/base/config/program_file.h"

namespace sinew::launch {

namespace fs = std::filesystem;

namespace {

bool IsProgram(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error) && ::access(path.c_str(), X_OK) == 0;
}

}  // namespace

fs::path ProgramFolder() { return config::ProgramFile().parent_path(); }

fs::path FindProgram(const std::string& program, const fs::path& base, const fs::path& folder) {
  if (program.find('/') != std::string::npos) {
    const fs::path path = fs::path(program).is_absolute() ? fs::path(program) : base / program;
    return IsProgram(path) ? fs::absolute(path).lexically_normal() : fs::path();
  }
  if (IsProgram(folder / program)) return folder / program;
  const char* search_path = std::getenv("PATH");
  std::istringstream folders(search_path != nullptr ? search_path : "");
  for (std::string entry; std::getline(folders, entry, ':');) {
    if (!entry.empty() && IsProgram(fs::path(entry) / program)) return fs::path(entry) / program;
  }
  return {};
}

std::string NoProgram(const std::string& program, const fs::path& folder) {
  return "no program '" + program + "', expected one in " + folder.string() +
         ", in PATH, or a path to an executable file";
}

}  // namespace sinew::launch
