// The robot that the page draws: its URDF, which of its joints joint_state has, and its meshes.
//
// Set-up only, but for Mesh, which reads a file; any thread.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tools/view/server.h"

namespace sinew::live {

class Robot {
 public:
  // Throws UsageError naming the file: not readable, no URDF.
  explicit Robot(const std::filesystem::path& urdf);

  const std::string& urdf() const { return urdf_; }
  // Joints in the order of the URDF: those that it drives (they move and have an effort above 0),
  // and all that move. joint_state has one of the two, by their number.
  const std::vector<std::string>& driven() const { return driven_; }
  const std::vector<std::string>& moving() const { return moving_; }
  // A file that the URDF names, by that name without "package://". Status 404: it names no such
  // file, or it is not there. Looked for beside the URDF, then in the folders above it.
  HttpReply Mesh(const std::string& name) const;

 private:
  std::string urdf_;
  std::vector<std::string> driven_, moving_;
  std::map<std::string, std::filesystem::path> meshes_;
};

// What stands in filename="..." of an URDF, without "package://".
std::vector<std::string> FilesNamedIn(const std::string& urdf);

}  // namespace sinew::live
