// The report as JSON, and pictures through gnuplot.
#pragma once

#include <string>
#include <vector>

#include "components/report/report.h"

namespace sinew::report {

// report.json; keys are documented in docs/formats.md.
std::string FormatJson(const Report& report);

// SVG text of each picture. Without gnuplot each is a paragraph that says so. Throws
// std::runtime_error with gnuplot's words when it refuses a script.
std::vector<std::string> DrawPictures(const std::vector<Picture>& pictures);

}  // namespace sinew::report
