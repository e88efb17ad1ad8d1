#include "components/model/report/section.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "components/base/types/printable.h"
#include "components/model/report/page_assets.h"

namespace sinew::report {

namespace {

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

// Its id, else its title as one.
std::string Anchor(const Section& section) {
  if (!section.id.empty()) return section.id;
  std::string out = section.title;
  for (char& c : out) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '-';
  }
  return out;
}

// Words of the tables' heads, in the words of docs/glossary.md.
struct Word {
  std::string_view word, meaning;
};
constexpr std::array kWords = {
    Word{"declared", "the model file as it was given"},
    Word{"refitted", "the declared terms fitted to the training recordings, nothing added"},
    Word{"corrected", "the declared terms and the effects that were found, fitted together"},
    Word{"held out", "a recording that took no part in search and fit"},
    Word{"held-out recordings",
         "on the recordings that took no part: confirmed, open or refuted, and the slope of their "
         "residual on what the effect predicts, 1 where the size is the same"},
    Word{"removes in training", "by how much the effect lowers the error of training"},
    Word{"rms", "root of the mean square over the rows that are used"},
    Word{"size, 95 %", "fitted size, with the interval that holds the true one in 95 of 100 cases"},
    Word{"p", "probability of the name, if the cause is one of the catalogue"},
    Word{"sigma", "shift of the fitted value over its standard deviation"},
    Word{"tolerance", "how far from the declared value the model file expects the true one"},
    Word{"smallest detectable size", "an effect of this size would have been found in most cases"},
    Word{"share of the measured side", "of the drive's torque, root of mean squares"},
    Word{"statistic", "the number that the rule compares with its limit"},
};

// A row of heads; those that are in the list say what they mean.
std::string Heads(const std::vector<std::string>& texts) {
  std::vector<std::string> cells = Cells(texts);
  for (std::size_t k = 0; k < texts.size(); ++k) {
    const auto* const found = std::find_if(kWords.begin(), kWords.end(),
                                           [&](const Word& each) { return each.word == texts[k]; });
    if (found == kWords.end()) continue;
    cells[k] = "<abbr tabindex=\"0\" title=\"" + Escape(std::string(found->meaning)) + "\">" +
               cells[k] + "</abbr>";
  }
  return Row(cells, "th");
}

std::string Numbers(const std::vector<double>& values, const char* format) {
  std::string out;
  for (const double value : values) {
    out += std::isfinite(value) ? std::string(Text(format, value)) : "-";
    out += ' ';
  }
  return out;
}

// The numbers of a picture, for the script of the page.
std::string FormatTraces(const Traces& traces) {
  const auto list = [](const std::string& attributes, const std::string& numbers) {
    return "<script type=\"text/plain\"" + attributes + ">" + numbers + "</script>\n";
  };
  std::string out = "<div class=\"chart\" data-x=\"" + Escape(traces.x_label) +
                    Text("\" data-from=\"%.7g\" data-to=\"%.7g\">\n", traces.from, traces.to) +
                    list("", Numbers(traces.x, "%.7g"));
  for (const Panel& panel : traces.panels) {
    for (const Series& series : panel.series) {
      out += list(" data-panel=\"" + Escape(panel.label) + "\" data-name=\"" + Escape(series.name) +
                      "\" data-colour=\"" + Escape(series.colour) + "\"",
                  Numbers(series.y, "%.5g"));
    }
  }
  return out + "</div>\n";
}

bool IsDrawnByThePage(const Section& section) {
  return std::any_of(section.pictures.begin(), section.pictures.end(),
                     [](const Picture& picture) { return picture.traces.has_value(); });
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
         Escape(title) + "</title><style>" + kPageStyle + "</style></head><body><main>\n";
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
    out += "<div class=\"wide\"><table>" + Heads(table.header);
    for (const auto& row : table.rows) out += Row(Cells(row));
    out += "</table></div>\n";
    if (!table.caption.empty()) out += Caption(table.caption) + "\n";
  }
  for (std::size_t i = 0; i < section.pictures.size() && i < section.svgs.size(); ++i) {
    const Picture& picture = section.pictures[i];
    out += "<figure><h3>" + Escape(picture.title) + "</h3>" +
           (picture.traces ? FormatTraces(*picture.traces) : "") + section.svgs[i] +
           Caption(picture.caption) + "</figure>\n";
  }
  if (section.seconds > 0.0) out += Caption(Text("It took %.1f s.", section.seconds)) + "\n";
  if (out.empty() || section.title.empty()) return out;
  return "<h2 id=\"" + Anchor(section) + "\">" + Escape(section.title) + "</h2>\n" + out;
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
  std::string contents, sections;
  for (const Section& section : page.sections) {
    const std::string text = FormatSection(section);
    if (!section.title.empty() && !text.empty()) {
      contents += "<a href=\"#" + Anchor(section) + "\">" + Escape(section.title) + "</a> ";
    }
    sections += text;
  }
  if (!contents.empty()) out += "<nav>" + contents + "</nav>\n";
  out += sections;
  if (!page.made.empty()) out += "<h2>How it was made</h2>\n<p>" + Escape(page.made) + "</p>\n";
  out += "</main>";
  if (std::any_of(page.sections.begin(), page.sections.end(), IsDrawnByThePage)) {
    out += std::string("<style>") + kPlotStyle + "</style><script type=\"module\">" + kPlotScript +
           kPageScript + "</script>";
  }
  return out + "</body></html>\n";
}

std::string Short(double value) { return Text("%.4g", value); }

}  // namespace sinew::report
