// A section of results as text on the standard output.
#pragma once

#include "components/model/report/section.h"

namespace sinew::tools {

void PrintSection(const report::Section& section);
// True when every target that there is was met.
bool AllMet(const report::Section& section);

}  // namespace sinew::tools
