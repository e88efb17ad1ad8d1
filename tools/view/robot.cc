#include "tools/view/robot.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <regex>

#include "components/base/config/config.h"
#include "components/bodies/links/file/urdf_file.h"
#include "tools/view/page.h"

namespace sinew::live {

namespace fs = std::filesystem;

namespace {

// own: the folder of the URDF, links followed.
fs::path PackageOf(const fs::path& own) {
  std::error_code error;
  for (fs::path folder = own; folder.has_relative_path(); folder = folder.parent_path()) {
    if (fs::is_regular_file(folder / "package.xml", error)) return folder;
  }
  return own.filename() == "urdf" ? own.parent_path() : own;
}

bool IsInside(const fs::path& file, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first ==
         folder.end();
}

// Links followed; empty: there is none. package://NAME is beside the package, NAME its folder.
fs::path FileInPackage(const std::string& name, const fs::path& own, const fs::path& package) {
  std::error_code error;
  for (fs::path folder = own; folder.has_relative_path(); folder = folder.parent_path()) {
    fs::path file = fs::canonical(folder / name, error);
    if (!error && fs::is_regular_file(file, error) && IsInside(file, package)) return file;
  }
  return {};
}

}  // namespace

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
  const fs::path own = fs::canonical(urdf).parent_path();
  const fs::path package = PackageOf(own);
  std::vector<std::string> left_out;
  for (const std::string& name : FilesNamedIn(urdf_)) {
    const fs::path file = FileInPackage(name, own, package);
    try {
      meshes_[name] = {200, ContentType(file), config::ReadFile(file, config::kLargestData)};
    } catch (const UsageError&) {  // an empty path among them
      left_out.push_back(name);
    }
  }
  if (left_out.empty()) return;
  spdlog::warn("{}: {} files that it names are not served, such as '{}', expected them in {}",
               urdf.string(), left_out.size(), left_out.front(), package.string());
}

HttpReply Robot::Mesh(const std::string& name) const {
  const auto found = meshes_.find(name);
  if (found != meshes_.end()) return found->second;
  return {404, "text/plain; charset=utf-8",
          name + ": the URDF names no such file of its package\n"};
}

}  // namespace sinew::live
