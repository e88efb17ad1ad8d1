// The files that a deployment consists of: its own, the configurations of its processes, and what
// these name - models, URDFs, weights, reference trajectories.
//
// Set-up only. Reads files; one that is no YAML names nothing.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/launch/deployment.h"

namespace sinew::launch {

struct DeploymentFile {
  // Relative to the deployment's folder where it is inside, else the file's own name, with a number
  // where that is taken.
  std::string name;
  std::filesystem::path path;  // absolute
};

// In the order in which they are named, each once. A text of a YAML file counts as a path when it
// is that of a file that exists, relative to the folder of the YAML file as config::Section reads
// paths; an argument of a process also when it is relative to the working folder. Recordings
// (.mcap) are left out: they are not configuration, and large; so are keys (.key, network.key),
// which whoever gets a recording must not get.
std::vector<DeploymentFile> FilesOf(const Deployment& deployment);

}  // namespace sinew::launch
