#include "tools/sinew/print_section.h"

#include <algorithm>

#include "tools/sinew/printed.h"

namespace sinew::tools {

namespace {

constexpr std::size_t kWidest = 140;  // columns of a terminal

std::string OneLine(std::string cell) {
  for (std::size_t at = 0; (at = cell.find('\n', at)) != std::string::npos;) {
    cell.replace(at, 1, "; ");
  }
  return cell;
}

void PrintTable(const report::Table& table) {
  if (!table.title.empty()) Print("\n%s\n", table.title.c_str());
  std::vector<std::vector<std::string>> rows = {table.header};
  rows.insert(rows.end(), table.rows.begin(), table.rows.end());
  std::vector<std::size_t> width(table.header.size());
  std::size_t all = 0;
  for (std::size_t c = 0; c < width.size(); ++c) {
    for (auto& row : rows) {
      row[c] = OneLine(row[c]);
      width[c] = std::max(width[c], row[c].size());
    }
    all += width[c] + 2;
  }
  if (all <= kWidest) {
    for (const auto& row : rows) {
      for (std::size_t c = 0; c < row.size(); ++c) {
        Print(c == 0 ? "%-*s" : "  %*s", static_cast<int>(width[c]), row[c].c_str());
      }
      Print("\n");
    }
    return;
  }
  for (std::size_t r = 1; r < rows.size(); ++r) {
    Print("%s\n", rows[r][0].c_str());
    for (std::size_t c = 1; c < rows[r].size(); ++c) {
      if (!rows[r][c].empty()) Print("  %s: %s\n", rows[0][c].c_str(), rows[r][c].c_str());
    }
  }
}

}  // namespace

void PrintSection(const report::Section& section) {
  for (const report::Comparison& line : section.comparisons) {
    Print("%-54s %10s", line.name.c_str(), line.ours.c_str());
    if (!line.published.empty()) Print("   published %s", line.published.c_str());
    if (!line.target.empty()) {
      Print("   reach: %s, %s", line.target.c_str(), *line.met ? "met" : "MISSED");
    }
    Print("\n");
  }
  for (const report::Table& table : section.tables) PrintTable(table);
}

void PrintPage(const report::Page& page) {
  Print("verdict: %s%s\n%s\n", page.verdict.c_str(),
        page.outcome == page.verdict ? "" : (" (" + page.outcome + ")").c_str(),
        page.sentence.c_str());
  for (const report::Section& section : page.sections) {
    const bool empty = std::all_of(section.tables.begin(), section.tables.end(),
                                   [](const report::Table& table) { return table.rows.empty(); });
    if (section.detail || (empty && section.paragraphs.empty())) continue;
    Print("\n%s\n", section.title.c_str());
    for (const std::string& paragraph : section.paragraphs) Print("%s\n", paragraph.c_str());
    if (!empty) PrintSection(section);
  }
}

bool AllMet(const report::Section& section) {
  return std::all_of(section.comparisons.begin(), section.comparisons.end(),
                     [](const report::Comparison& c) { return c.met.value_or(true); });
}

}  // namespace sinew::tools
