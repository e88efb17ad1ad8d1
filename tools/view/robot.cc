#include "tools/view/robot.h"

#include <regex>

#include "components/base/config/config.h"
#include "components/bodies/links/file/urdf_file.h"
#include "tools/view/page.h"

namespace sinew::live {

namespace fs = std::filesystem;

std::vector<std::string> FilesNamedIn(const std::string& urdf) {
  // std::regex visits letters by recursion, so repetitions have a limit.
  static const std::regex kFile(
      R"re(filename\s{0,9}=\s{0,9}["'](?:package://)?([^"']{1,1023})["'])re");
  std::vector<std::string> names;
  for (std::sregex_iterator it(urdf.begin(), urdf.end(), kFile), end; it != end; ++it) {
    names.push_back((*it)[1]);
  }
  return names;
}

Robot::Robot(const fs::path& urdf) : urdf_(config::ReadFile(urdf)) {
  const arm::Chain chain = arm::ParseUrdf(urdf_, urdf.string());
  for (const arm::Body& body : chain.bodies) {
    if (!body.moves) continue;
    moving_.push_back(body.joint_name);
    if (arm::IsDriven(body)) driven_.push_back(body.joint_name);
  }
  const fs::path beside = fs::absolute(urdf).parent_path();
  for (const std::string& name : FilesNamedIn(urdf_)) {
    std::error_code error;
    for (fs::path folder = beside; folder.has_relative_path(); folder = folder.parent_path()) {
      if (fs::is_regular_file(folder / name, error)) {
        meshes_[name] = folder / name;
        break;
      }
    }
  }
}

HttpReply Robot::Mesh(const std::string& name) const {
  const auto found = meshes_.find(name);
  if (found == meshes_.end()) {
    return {404, "text/plain; charset=utf-8", name + ": the URDF names no such file\n"};
  }
  try {
    return {200, ContentType(found->second), config::ReadFile(found->second, config::kLargestData)};
  } catch (const UsageError& error) {
    return {404, "text/plain; charset=utf-8", std::string(error.what()) + "\n"};
  }
}

}  // namespace sinew::live
