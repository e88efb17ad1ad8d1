#include "tools/view/page.h"

#include "components/base/config/config.h"

namespace sinew::live {

namespace fs = std::filesystem;

namespace {

constexpr const char* kIndex = "/index.html";
constexpr const char* kTokenMark = "@TOKEN@";

}  // namespace

std::string ContentType(const fs::path& file) {
  static const std::map<std::string, std::string> kTypes = {
      {".html", "text/html; charset=utf-8"},
      {".css", "text/css; charset=utf-8"},
      {".js", "text/javascript; charset=utf-8"},
      {".json", "application/json"},
      {".svg", "image/svg+xml"},
      {".png", "image/png"},
      {".txt", "text/plain; charset=utf-8"},
      {".urdf", "application/xml"},
      {".stl", "model/stl"},
      {".dae", "model/vnd.collada+xml"},
  };
  const auto found = kTypes.find(file.extension().string());
  return found == kTypes.end() ? "application/octet-stream" : found->second;
}

Page::Page(const fs::path& folder) {
  std::error_code error;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder, error)) {
    if (!entry.is_regular_file()) continue;
    files_["/" + fs::relative(entry.path(), folder).generic_string()] = {
        200, ContentType(entry.path()), config::ReadFile(entry.path())};
  }
  if (!files_.contains(kIndex)) {
    throw UsageError(folder.string() + ": no index.html, expected the page's files in this folder");
  }
}

HttpReply Page::Get(const std::string& path, const std::string& token) const {
  const auto found = files_.find(path == "/" ? kIndex : path);
  if (found == files_.end()) return {404, "text/plain; charset=utf-8", path + ": no such file\n"};
  HttpReply reply = found->second;
  if (found->first == kIndex) {
    const std::size_t mark = reply.body.find(kTokenMark);
    if (mark != std::string::npos) {
      reply.body.replace(mark, std::string(kTokenMark).size(), token);
    }
  }
  return reply;
}

}  // namespace sinew::live
