// Style and script of every page, from the files of page/ and, for its charts, uPlot as tools/view
// has it.
#pragma once

namespace sinew::report {

extern const char* const kPageStyle;   // page/page.css
extern const char* const kPageScript;  // page/page.js
extern const char* const kPlotStyle;
extern const char* const kPlotScript;

}  // namespace sinew::report
