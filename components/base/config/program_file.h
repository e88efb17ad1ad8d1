// The file of this program.
#pragma once

#include <filesystem>

namespace sinew::config {

// As it was named when this was called first: a process that enters other mounts (isolation/) calls
// it before, since the kernel then names the file by the mounts that it left. Empty: not known.
const std::filesystem::path& ProgramFile();

}  // namespace sinew::config
