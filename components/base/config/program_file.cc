#include "components/base/config/program_file.h"

#include <system_error>

namespace sinew::config {

const std::filesystem::path& ProgramFile() {
  static const std::filesystem::path file = [] {
    std::error_code unknown;
    return std::filesystem::read_symlink("/proc/self/exe", unknown);
  }();
  return file;
}

}  // namespace sinew::config
