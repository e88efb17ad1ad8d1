// The report as JSON.
#pragma once

#include <string>

#include "components/report/file/section_file.h"
#include "components/report/report.h"

namespace sinew::report {

// report.json; keys are documented in docs/formats.md.
std::string FormatJson(const Report& report);

}  // namespace sinew::report
