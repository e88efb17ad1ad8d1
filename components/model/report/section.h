// Results as sections of a page: sentences, tables, pictures; what one command measured, beside
// what was published.
//
// Commands write their sections as files (file/section_file.h); a page is made of several. HTML
// (here) and the terminal (tools/sinew/print_section.h) print the same sections. Pure data and
// text.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "components/base/types/text.h"
#include "components/model/report/picture.h"

namespace sinew::report {

// One figure beside the published one. Text fields are shown as they are; empty ones as a dash.
struct Comparison {
  std::string name{};         // "backlash"
  std::string unit{};         // "degrees"
  std::string published{};    // "2.66", with its table or figure number in `source`
  std::string source{};       // "Fig 5.1"
  std::string ours{};         // "2.662"
  std::string interval{};     // 95 %: "2.655 .. 2.669"
  std::string truth{};        // of the surrogate, where there is one
  std::string target{};       // "within 0.05 degrees"
  std::optional<bool> met{};  // of the target; nothing: no target
  std::string remark{};
};

struct Table {
  std::string title{};
  std::string caption{};
  std::vector<std::string> header{};
  std::vector<std::vector<std::string>> rows{};  // as long as the header each
};

struct Section {
  std::string id{};     // a word of a-z, 0-9 and '-': file and anchor names; empty: no anchor
  std::string title{};  // "Backlash (Fig 5.1)"; empty: no heading
  std::vector<std::string> paragraphs{};
  std::vector<Comparison> comparisons{};
  std::vector<Table> tables{};
  std::vector<Picture> pictures{};
  // Filled by DrawnHtml, WriteSection and ReadSection: SVG of each picture.
  std::vector<std::string> svgs{};
  double seconds = 0.0;  // it took; 0: nothing is said about it
  bool detail = false;   // on the page alone, not on the terminal

  // A row of the last table.
  void Add(std::vector<std::string> cells) { tables.back().rows.push_back(std::move(cells)); }
};

// A section of one table.
Section TableSection(std::string title, std::vector<std::string> header, std::string caption = "",
                     bool detail = false);

// A result as a page.
struct Page {
  std::string title;    // "Closing the loop: rig, joint 1"
  std::string meta;     // which recordings and model
  std::string made{};   // when, where and by which command; stands at the end
  std::string verdict;  // "effect"
  std::string outcome;  // finer; sets the colour of the bar
  std::string sentence;
  std::vector<std::pair<std::string, std::string>> figures{};  // "0.04 Nm", and what it is
  std::vector<Section> sections{};
};

// Throws std::invalid_argument naming what is wrong: id, empty title, rows of another length.
void CheckSection(const Section& section);

// Titles, sentences and cells are text; a line end in a cell is one on the page, an empty cell is a
// dash. A section without anything in it is left out.
std::string FormatHtml(const Page& page);

// Pieces of pages.
std::string Escape(const std::string& text);
std::string FormatSection(const Section& section);
// From <!DOCTYPE to <main>. title is text.
std::string HtmlHead(const std::string& title);
// A number for people: four significant digits.
std::string Short(double value);
using types::Text;

}  // namespace sinew::report
