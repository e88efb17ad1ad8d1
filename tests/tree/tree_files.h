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

// Cells of the rows of a Markdown table below a heading, its two header rows left out.
inline std::vector<std::vector<std::string>> TableBelow(const std::string& text,
                                                        const std::string& heading) {
  std::vector<std::vector<std::string>> rows;
  bool below = false;
  for (const std::string& line : Lines(text)) {
    if (StartsWith(line, "#")) below = line == heading;
    if (!below || !StartsWith(line, "| ")) continue;
    std::vector<std::string> cells;
    for (std::size_t at = 1; at < line.size();) {
      const std::size_t end = std::min(line.find('|', at), line.size());
      const std::string cell = line.substr(at, end - at);
      const std::size_t first = cell.find_first_not_of(' ');
      if (end < line.size() || first != std::string::npos) {
        cells.push_back(
            first == std::string::npos
                ? ""
                : cell.substr(first, cell.find_last_not_of(' ') - first + std::size_t{1}));
      }
      at = end + 1;
    }
    rows.push_back(std::move(cells));
  }
  if (rows.size() < 2) return {};
  return {rows.begin() + 2, rows.end()};
}

}  // namespace sinew
