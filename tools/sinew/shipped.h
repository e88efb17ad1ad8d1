// Files that come with the program.
#pragma once

#include <filesystem>

namespace sinew::tools {

// A folder of the project, by its path in the tree ("robots", "reproduction/papers"), beside the
// installed program (../share/sinew) or in the tree that built it; empty when there is none.
std::filesystem::path ShippedFolder(const std::filesystem::path& wanted);

// The folder robots/.
std::filesystem::path RobotsFolder();

// robots/FILE. Throws UsageError when it is not there.
std::filesystem::path ShippedRobotFile(const std::filesystem::path& file);

// A CSV mapping that was not given: csv_map.yaml beside the model, else the rig's.
std::filesystem::path DefaultCsvMap(const std::filesystem::path& model);

}  // namespace sinew::tools
