// A part of a page of results: what one command measured, beside what was published.
//
// Commands write their sections as files (file/section_file.h); a page is made of several. Pure
// data and text.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "components/model/report/picture.h"

namespace sinew::report {

// One figure beside the published one. Text fields are shown as they are; empty ones as a dash.
struct Comparison {
  std::string name;         // "backlash"
  std::string unit;         // "degrees"
  std::string published;    // "2.66", with its table or figure number in `source`
  std::string source;       // "Fig 5.1"
  std::string ours;         // "2.662"
  std::string interval;     // 95 %: "2.655 .. 2.669"
  std::string truth;        // of the surrogate, where there is one
  std::string target;       // "within 0.05 degrees"
  std::optional<bool> met;  // of the target; nothing: no target
  std::string remark;
};

struct Table {
  std::string title;
  std::string caption;
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;  // as long as the header each
};

struct Section {
  std::string id;     // a word of a-z, 0-9 and '-': file and anchor names
  std::string title;  // "Backlash (Fig 5.1)"
  std::vector<std::string> paragraphs;
  std::vector<Comparison> comparisons;
  std::vector<Table> tables;
  std::vector<Picture> pictures;
  // Filled by WriteSection and ReadSection: SVG of each picture.
  std::vector<std::string> svgs;
  double seconds = 0.0;  // it took
};

// Throws std::invalid_argument naming what is wrong: id, empty title, rows of another length.
void CheckSection(const Section& section);

// Pieces of pages.
std::string Escape(const std::string& text);
// cells are HTML.
std::string HtmlRow(const std::vector<std::string>& cells, const char* tag = "td");
// From <!DOCTYPE to <main>. title is text.
std::string HtmlHead(const std::string& title);
// A number for people: four significant digits.
std::string Short(double value);
// As std::printf, into a string of whatever length it needs.
__attribute__((format(printf, 1, 2))) std::string Text(const char* format, ...);

}  // namespace sinew::report
