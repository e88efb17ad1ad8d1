// The robot that the page draws: its URDF, which of its joints joint_state has, and its meshes.
//
// The URDF may be a stranger's: what it names is served from inside its package only, the nearest
// folder from its own on upwards that has a package.xml, else its own (of NAME/urdf/: NAME).
//
// Meshes and textures that are not there, or not to be served, are logged: a line each, ten at
// most, with file, line, link and name. Reads files in the constructor only; any thread.
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

  // With the materials that it refers to (arm::DefineMaterials) and files as paths: NAME/REST of
  // package://NAME/REST, whatever the package's folder is called, PATH of file://PATH.
  const std::string& urdf() const { return urdf_; }
  // Joints in the order of the URDF: those that it drives (they move and have an effort above 0),
  // and all that move. joint_state has one of the two, by their number.
  const std::vector<std::string>& driven() const { return driven_; }
  const std::vector<std::string>& moving() const { return moving_; }
  // A file that the URDF names, by the name that urdf() has for it, looked for beside the URDF,
  // then in the folders above it. Status 404: it names no such file, or there is none in its
  // package.
  HttpReply Mesh(const std::string& name) const;

 private:
  std::string urdf_;
  std::vector<std::string> driven_, moving_;
  std::map<std::string, HttpReply> meshes_;
};

}  // namespace sinew::live
