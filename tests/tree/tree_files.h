// Files of the project as text, for the tests that read the tree. Paths are relative to the root.
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace sinew {

inline const std::filesystem::path kRoot = SINEW_SOURCE_DIR;

inline std::string Read(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

inline std::vector<std::string> Lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

// Files of the project below a folder; build trees, hidden folders and what others wrote (vendor/)
// left out.
inline std::vector<std::string> Files(const std::string& below = "") {
  namespace fs = std::filesystem;
  std::vector<std::string> files;
  const fs::path start = kRoot / below;
  if (!fs::exists(start)) return files;
  for (auto it = fs::recursive_directory_iterator(start); it != fs::recursive_directory_iterator();
       ++it) {
    const std::string name = it->path().filename();
    if (it->is_directory() && (name == "build" || name == "install" || name == "node_modules" ||
                               name == "vendor" || (name.front() == '.' && name != ".ci"))) {
      it.disable_recursion_pending();
    } else if (it->is_regular_file()) {
      files.push_back(fs::relative(it->path(), kRoot).string());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

inline bool EndsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}
inline bool StartsWith(const std::string& text, const std::string& begin) {
  return text.rfind(begin, 0) == 0;
}

}  // namespace sinew
