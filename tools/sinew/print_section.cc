#include "tools/sinew/print_section.h"

#include <algorithm>
#include <cstdio>

#include "tools/sinew/printed.h"

namespace sinew::tools {

void PrintSection(const report::Section& section) {
  for (const report::Comparison& line : section.comparisons) {
    Print("%-54s %10s", line.name.c_str(), line.ours.c_str());
    if (!line.published.empty()) Print("   published %s", line.published.c_str());
    if (!line.target.empty()) {
      Print("   reach: %s, %s", line.target.c_str(), *line.met ? "met" : "MISSED");
    }
    Print("\n");
  }
  for (const report::Table& table : section.tables) {
    Print("\n%s\n", table.title.c_str());
    std::vector<std::size_t> width(table.header.size());
    for (std::size_t c = 0; c < width.size(); ++c) {
      width[c] = table.header[c].size();
      for (const auto& row : table.rows) width[c] = std::max(width[c], row[c].size());
    }
    const auto print = [&width](const std::vector<std::string>& row) {
      for (std::size_t c = 0; c < row.size(); ++c) {
        Print(c == 0 ? "%-*s" : "  %*s", static_cast<int>(width[c]), row[c].c_str());
      }
      Print("\n");
    };
    print(table.header);
    for (const auto& row : table.rows) print(row);
  }
}

bool AllMet(const report::Section& section) {
  return std::all_of(section.comparisons.begin(), section.comparisons.end(),
                     [](const report::Comparison& c) { return c.met.value_or(true); });
}

}  // namespace sinew::tools
