// The result of close-loop on a standing robot as JSON.
#pragma once

#include <string>

#include "components/model/report/stance_page.h"

namespace sinew::report {

// report.json; keys are documented in docs/formats.md.
std::string FormatJson(const StanceReport& report);

}  // namespace sinew::report
