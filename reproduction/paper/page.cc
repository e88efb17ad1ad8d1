#include "reproduction/paper/page.h"

#include <cstdio>
#include <optional>

namespace sinew::reproduction {
namespace {

std::string OrDash(const std::string& text) {
  return text.empty() ? "&ndash;" : report::Escape(text);
}

std::string Verdict(const std::optional<bool>& met) {
  if (!met) return "&ndash;";
  return *met ? "<span class=\"met\">met</span>" : "<span class=\"missed\">missed</span>";
}

std::vector<std::string> Cells(const report::Comparison& line) {
  std::string name = report::Escape(line.name);
  if (!line.unit.empty()) name += ", " + report::Escape(line.unit);
  if (!line.remark.empty())
    name += "<br><span class=\"caption\">" + report::Escape(line.remark) + "</span>";
  std::string published = OrDash(line.published);
  if (!line.source.empty()) {
    published += " <span class=\"caption\">" + report::Escape(line.source) + "</span>";
  }
  return {name,
          published,
          OrDash(line.ours),
          OrDash(line.interval),
          OrDash(line.truth),
          OrDash(line.target),
          Verdict(line.met)};
}

const std::vector<std::string> kHeader{"figure",           "published", "here",   "95 % interval",
                                       "of the surrogate", "target",    "reached"};

std::string FormatSection(const report::Section& section) {
  std::string out = "<h2 id=\"" + section.id + "\">" + report::Escape(section.title) + "</h2>\n";
  for (const std::string& paragraph : section.paragraphs) {
    out += "<p>" + report::Escape(paragraph) + "</p>\n";
  }
  if (!section.comparisons.empty()) {
    out += "<div class=\"wide\"><table>" + report::HtmlRow(kHeader, "th");
    for (const report::Comparison& line : section.comparisons) out += report::HtmlRow(Cells(line));
    out += "</table></div>\n";
  }
  for (const report::Table& table : section.tables) {
    out += "<h3>" + report::Escape(table.title) + "</h3>\n<div class=\"wide\"><table>";
    std::vector<std::string> header;
    header.reserve(table.header.size());
    for (const std::string& cell : table.header) header.push_back(report::Escape(cell));
    out += report::HtmlRow(header, "th");
    for (const auto& row : table.rows) {
      std::vector<std::string> cells;
      cells.reserve(row.size());
      for (const std::string& cell : row) cells.push_back(OrDash(cell));
      out += report::HtmlRow(cells);
    }
    out += "</table></div>\n";
    if (!table.caption.empty())
      out += "<p class=\"caption\">" + report::Escape(table.caption) + "</p>\n";
  }
  for (std::size_t i = 0; i < section.pictures.size() && i < section.svgs.size(); ++i) {
    out += "<figure><h3>" + report::Escape(section.pictures[i].title) + "</h3>" + section.svgs[i] +
           "<p class=\"caption\">" + report::Escape(section.pictures[i].caption) +
           "</p></figure>\n";
  }
  char took[64];
  std::snprintf(took, sizeof took, "<p class=\"caption\">It took %.1f s.</p>\n", section.seconds);
  return out + took;
}

}  // namespace

std::string FormatPage(const PageText& text, const std::vector<report::Section>& sections) {
  std::string out = report::HtmlHead(text.title);
  out += "<h1>" + report::Escape(text.title) + "</h1>\n<div class=\"meta\">" +
         report::Escape(text.introduction) + "</div>\n<ul>";
  for (const report::Section& section : sections) {
    out += "<li><a href=\"#" + section.id + "\">" + report::Escape(section.title) + "</a></li>";
  }
  out += "</ul>\n";
  std::string targets;
  int met = 0, all = 0;
  for (const report::Section& section : sections) {
    for (const report::Comparison& line : section.comparisons) {
      if (!line.met) continue;
      ++all;
      met += *line.met ? 1 : 0;
      targets += report::HtmlRow(Cells(line));
    }
  }
  if (all > 0) {
    out += "<h2 id=\"targets\">Targets: " + std::to_string(met) + " of " + std::to_string(all) +
           " reached</h2>\n<div class=\"wide\"><table>" + report::HtmlRow(kHeader, "th") + targets +
           "</table></div>\n";
  }
  for (const report::Section& section : sections) out += FormatSection(section);
  return out + "</main></body></html>\n";
}

}  // namespace sinew::reproduction
