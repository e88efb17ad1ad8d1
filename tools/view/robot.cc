#include "tools/view/robot.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <set>
#include <string_view>

#include "components/base/config/config.h"
#include "components/bodies/links/file/urdf_file.h"
#include "components/bodies/links/file/xml_text.h"
#include "tools/view/page.h"
#include "tools/view/routes.h"

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

constexpr std::size_t kMostWarnings = 10;
constexpr std::string_view kPackage = "package://", kFile = "file://";

// A path, relative or not: package://NAME/REST is NAME/REST, of a file:// the address decoded.
std::string NameOf(const std::string& uri) {
  if (uri.starts_with(kPackage)) return uri.substr(kPackage.size());
  return uri.starts_with(kFile) ? PercentDecoded(uri.substr(kFile.size())) : uri;
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

Robot::Robot(const fs::path& urdf) {
  TiXmlDocument document;
  const std::string text = config::ReadFile(urdf);
  arm::ParseXml(text, urdf.string(), &document);
  const arm::Chain chain = arm::ParseUrdf(text, urdf.string());
  arm::DefineMaterials(urdf.string(), document.RootElement());
  for (const arm::Body& body : chain.bodies) {
    if (!arm::IsFree(body)) continue;
    moving_.push_back(body.joint_name);
    if (arm::IsDriven(body)) driven_.push_back(body.joint_name);
  }
  const fs::path own = fs::canonical(urdf).parent_path();
  const fs::path package = PackageOf(own);
  std::set<std::string> left_out;
  for (TiXmlElement* element : arm::ElementsIn(*document.RootElement())) {
    const bool is_file = element->ValueStr() == "mesh" || element->ValueStr() == "texture";
    if (!is_file || element->Attribute("filename") == nullptr) continue;
    const std::string uri = element->Attribute("filename"), name = NameOf(uri);
    element->SetAttribute("filename", name.c_str());
    if (meshes_.contains(name) || left_out.contains(name)) continue;
    fs::path file = FileInPackage(name, own, package);
    if (file.empty() && uri.starts_with(kPackage)) {  // a folder of another name
      file = FileInPackage(name.substr(name.find('/') + 1), package, package);
    }
    try {
      meshes_[name] = {200, ContentType(file), config::ReadFile(file, config::kLargestData)};
    } catch (const UsageError& error) {
      left_out.insert(name);
      if (left_out.size() > kMostWarnings) continue;
      spdlog::warn("{}{} '{}' is not drawn: {}", arm::PlaceIn(urdf.string(), *element),
                   element->ValueStr(), uri,
                   file.empty() ? "no such file in " + package.string() : error.what());
    }
  }
  if (left_out.size() > kMostWarnings) {
    spdlog::warn("{}: {} more files that it names are not drawn", urdf.string(),
                 left_out.size() - kMostWarnings);
  }
  TiXmlPrinter printer;
  document.Accept(&printer);
  urdf_ = printer.Str();
}

HttpReply Robot::Mesh(const std::string& name) const {
  const auto found = meshes_.find(name);
  if (found != meshes_.end()) return found->second;
  return {404, "text/plain; charset=utf-8",
          name + ": the URDF names no such file of its package\n"};
}

}  // namespace sinew::live
