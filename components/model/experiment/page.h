// A result as a section of a page: comparisons, tables, pictures.
#pragma once

#include <string>

#include "components/model/experiment/result.h"
#include "components/model/report/section.h"

namespace sinew::experiment {

// A number for people and its interval, with as many digits as the interval allows.
std::string FormatValue(double value);
std::string FormatEstimate(const Quantity& quantity);
std::string FormatInterval(const Quantity& quantity);
std::string FormatTarget(const Quantity& quantity);  // empty: no target

report::Section MakeSection(const Result& result);

}  // namespace sinew::experiment
