#include "components/model/report/section.h"

#include <stdexcept>

#include "components/base/types/printable.h"

namespace sinew::report {

namespace {

constexpr const char* kStyle = R"(
:root{--ink:#1f2933;--soft:#5f6b76;--line:#e1e5e9;--accent:#1b7f9e}
body{font:15px/1.5 "DejaVu Sans","Segoe UI",system-ui,sans-serif;color:var(--ink);margin:0;background:#f5f6f8}
main{max-width:960px;margin:0 auto;padding:28px 20px 60px}
h1{font-size:21px;margin:0 0 4px}h2{font-size:16px;margin:34px 0 8px}
.verdict{background:#fff;border-left:6px solid var(--accent);padding:16px 20px;margin:14px 0 18px;font-size:17px}
.verdict.none,.verdict.nothing,.verdict.ok{border-color:#7a9a5b}.verdict.unexplained,.verdict.open,.verdict.training_only,.verdict.not_detectable,.verdict.data_fault,.verdict.too_little_data{border-color:#d95f02}
.meta,.caption{color:var(--soft);font-size:13px}.caption{margin:2px 0 0}
figure{background:#fff;margin:18px 0;padding:14px 16px 12px}figure h3{font-size:14px;margin:0 0 4px}
figure svg{width:100%;height:auto;display:block}
table{border-collapse:collapse;width:100%;background:#fff;font-size:13.5px}
th,td{padding:6px 10px;border-bottom:1px solid var(--line);text-align:left;vertical-align:top}
th{font-weight:600;color:var(--soft);font-size:12.5px}td.n,th.n{text-align:right;font-variant-numeric:tabular-nums}
ul{margin:6px 0;padding-left:20px}.big{display:flex;gap:14px;flex-wrap:wrap;margin:0 0 18px}
.big div{background:#fff;padding:12px 18px;flex:1 1 190px}.big b{display:block;font-size:20px}
.big span{color:var(--soft);font-size:12.5px}code{font-size:12.5px}
.wide{overflow-x:auto}.wide+.wide{margin-top:14px}h3{font-size:14px;margin:18px 0 6px}.met{color:#4c7a2f}.missed{color:#b5402a;font-weight:600}
)";

constexpr const char* kDash = "&ndash;";

// cells are HTML.
std::string Row(const std::vector<std::string>& cells, const char* tag = "td") {
  std::string out = "<tr>";
  for (const std::string& cell : cells) {
    out += std::string("<") + tag + ">" + cell + "</" + tag + ">";
  }
  return out + "</tr>\n";
}

std::string OrDash(const std::string& text) {
  if (text.empty()) return kDash;
  std::string out = Escape(text);
  for (std::size_t at = 0; (at = out.find('\n', at)) != std::string::npos;) {
    out.replace(at, 1, "<br>");
  }
  return out;
}

std::string Caption(const std::string& text) {
  return "<p class=\"caption\">" + Escape(text) + "</p>";
}

std::vector<std::string> Cells(const std::vector<std::string>& texts) {
  std::vector<std::string> out;
  out.reserve(texts.size());
  for (const std::string& text : texts) out.push_back(OrDash(text));
  return out;
}

std::string Comparisons(const std::vector<Comparison>& comparisons) {
  if (comparisons.empty()) return "";
  std::string out =
      "<div class=\"wide\"><table>" +
      Row({"figure", "published", "here", "95 % interval", "of the surrogate", "target", "reached"},
          "th");
  for (const Comparison& line : comparisons) {
    std::string name = Escape(line.name), published = OrDash(line.published);
    if (!line.unit.empty()) name += ", " + Escape(line.unit);
    if (!line.remark.empty()) {
      name += "<br><span class=\"caption\">" + Escape(line.remark) + "</span>";
    }
    if (!line.source.empty()) {
      published += " <span class=\"caption\">" + Escape(line.source) + "</span>";
    }
    out += Row({name, published, OrDash(line.ours), OrDash(line.interval), OrDash(line.truth),
                OrDash(line.target),
                !line.met   ? kDash
                : *line.met ? "<span class=\"met\">met</span>"
                            : "<span class=\"missed\">missed</span>"});
  }
  return out + "</table></div>\n";
}

}  // namespace

void CheckSection(const Section& section) {
  if (section.id.empty() ||
      section.id.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-") != std::string::npos) {
    throw std::invalid_argument("section '" + section.id + "': id, expected a-z, 0-9 and '-'");
  }
  if (section.title.empty()) {
    throw std::invalid_argument("section '" + section.id + "': no title");
  }
  for (const Table& table : section.tables) {
    for (const auto& row : table.rows) {
      if (row.size() != table.header.size()) {
        throw std::invalid_argument("section '" + section.id + "': table '" + table.title +
                                    "': a row has " + std::to_string(row.size()) +
                                    " cells, expected " + std::to_string(table.header.size()));
      }
    }
  }
}

Section TableSection(std::string title, std::vector<std::string> header, std::string caption,
                     bool detail) {
  return {.title = std::move(title),
          .tables = {{"", std::move(caption), std::move(header), {}}},
          .detail = detail};
}

std::string Escape(const std::string& text) { return types::Entities(types::Utf8(text)); }

std::string HtmlHead(const std::string& title) {
  return "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
         "<meta name=\"viewport\" content=\"width=device-width\"><title>" +
         Escape(title) + "</title><style>" + kStyle + "</style></head><body><main>\n";
}

std::string FormatSection(const Section& section) {
  std::string out;
  for (const std::string& paragraph : section.paragraphs) {
    out += "<p>" + Escape(paragraph) + "</p>\n";
  }
  out += Comparisons(section.comparisons);
  for (const Table& table : section.tables) {
    if (table.rows.empty()) continue;
    if (!table.title.empty()) out += "<h3>" + Escape(table.title) + "</h3>\n";
    out += "<div class=\"wide\"><table>" + Row(Cells(table.header), "th");
    for (const auto& row : table.rows) out += Row(Cells(row));
    out += "</table></div>\n";
    if (!table.caption.empty()) out += Caption(table.caption) + "\n";
  }
  for (std::size_t i = 0; i < section.pictures.size() && i < section.svgs.size(); ++i) {
    out += "<figure><h3>" + Escape(section.pictures[i].title) + "</h3>" + section.svgs[i] +
           Caption(section.pictures[i].caption) + "</figure>\n";
  }
  if (section.seconds > 0.0) out += Caption(Text("It took %.1f s.", section.seconds)) + "\n";
  if (out.empty() || section.title.empty()) return out;
  const std::string anchor = section.id.empty() ? "" : " id=\"" + section.id + "\"";
  return "<h2" + anchor + ">" + Escape(section.title) + "</h2>\n" + out;
}

std::string FormatHtml(const Page& page) {
  std::string out = HtmlHead(page.title) + "<h1>" + Escape(page.title) + "</h1>\n" +
                    "<div class=\"meta\">" + Escape(page.meta) + "</div>\n" +
                    "<div class=\"verdict " + page.outcome + "\">" + Escape(page.sentence) +
                    "</div>\n";
  if (!page.figures.empty()) out += "<div class=\"big\">\n";
  for (const auto& [value, what] : page.figures) {
    out += "<div><b>" + Escape(value) + "</b><span>" + Escape(what) + "</span></div>\n";
  }
  if (!page.figures.empty()) out += "</div>\n";
  for (const Section& section : page.sections) out += FormatSection(section);
  return out + "</main></body></html>\n";
}

std::string Short(double value) { return Text("%.4g", value); }

}  // namespace sinew::report
