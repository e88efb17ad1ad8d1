// What a comparison says: for a terminal, for a program.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "components/report/section.h"
#include "reproduction/networks/comparison.h"

namespace sinew::reproduction {

std::string FormatComparison(const ComparisonResult& result);
// The tables, the order and a picture (Figs 6.6, 6.8) for a page of results.
report::Section ComparisonSection(const ComparisonResult& result);
nlohmann::ordered_json ComparisonJson(const ComparisonResult& result);

// Sentences: data, normalisation, inputs; where our order is another one than the published, and
// why.
std::vector<std::string> ComparisonParagraphs(const ComparisonResult& result);

}  // namespace sinew::reproduction
