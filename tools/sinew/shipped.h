// Files that come with the program.
#pragma once

#include <filesystem>

namespace sinew::tools {

// The folder robots/ beside the installed program (../share/sinew) or in the tree that built it;
// empty when there is none.
std::filesystem::path RobotsFolder();

// robots/FILE. Throws UsageError when it is not there.
std::filesystem::path ShippedRobotFile(const std::filesystem::path& file);

}  // namespace sinew::tools
