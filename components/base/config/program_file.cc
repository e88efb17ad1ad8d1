#include "components/base/config/program_file.h"

#include <system_error>

namespace sinew::config {

const std::filesystem::path& ProgramFile() {
  static const std::filesystem::path kFile = [] {
    std::error_code unknown;
    return std::filesystem::read_symlink("/proc/self/exe", unknown);
  }();
  return kFile;
}

}  // namespace sinew::config
