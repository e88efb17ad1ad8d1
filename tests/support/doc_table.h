// Defaults as a document lists them, to compare with those of the code.
#pragma once

#include <fstream>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

namespace sinew::test {

// Rows "| `key`, `other` | 1, 2 | ... |" of the tables of a document (path from the root): key ->
// its default as text. Rows whose first cell has more keys than the second has values are left out.
inline std::map<std::string, std::string> DefaultsIn(const std::string& document) {
  static const std::regex kRow(R"(\| (`[^|]*) \| ([^|]*) \|.*)");
  static const std::regex kKey("`([A-Za-z0-9_]+)`");
  std::ifstream in(std::string(SINEW_SOURCE_DIR) + "/" + document);
  std::map<std::string, std::string> out;
  for (std::string line; std::getline(in, line);) {
    std::smatch row;
    if (!std::regex_match(line, row, kRow)) continue;
    const std::string keys = row[1];
    std::vector<std::string> names, values;
    for (std::sregex_iterator it(keys.begin(), keys.end(), kKey), end; it != end; ++it) {
      names.push_back((*it)[1]);
    }
    std::istringstream cell(row[2]);
    for (std::string value; std::getline(cell >> std::ws, value, ',');) values.push_back(value);
    if (names.size() > values.size()) continue;
    for (std::size_t k = 0; k < names.size(); ++k) out[names[k]] = values[k];
  }
  return out;
}

}  // namespace sinew::test
