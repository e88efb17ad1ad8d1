// Sections of results as text on the standard output.
#pragma once

#include "components/model/report/section.h"

namespace sinew::tools {

// Comparisons and tables; a table that is too wide for a terminal row by row, a line for each cell.
void PrintSection(const report::Section& section);
// Verdict, sentence and the sections that are not detail.
void PrintPage(const report::Page& page);
// True when every target that there is was met.
bool AllMet(const report::Section& section);

}  // namespace sinew::tools
