#include "reproduction/paper/page.h"

namespace sinew::reproduction {

std::string FormatPage(const PageText& text, const std::vector<report::Section>& sections) {
  std::string out = report::HtmlHead(text.title);
  out += "<h1>" + report::Escape(text.title) + "</h1>\n<div class=\"meta\">" +
         report::Escape(text.introduction) + "</div>\n<ul>";
  report::Section targets;
  int met = 0;
  for (const report::Section& section : sections) {
    out += "<li><a href=\"#" + section.id + "\">" + report::Escape(section.title) + "</a></li>";
    for (const report::Comparison& line : section.comparisons) {
      if (!line.met) continue;
      met += *line.met ? 1 : 0;
      targets.comparisons.push_back(line);
    }
  }
  targets.id = "targets";
  targets.title = "Targets: " + std::to_string(met) + " of " +
                  std::to_string(targets.comparisons.size()) + " reached";
  out += "</ul>\n" + report::FormatSection(targets);
  for (const report::Section& section : sections) out += report::FormatSection(section);
  return out + "</main></body></html>\n";
}

}  // namespace sinew::reproduction
