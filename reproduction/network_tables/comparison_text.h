// The result of a comparison as text, as JSON, and as a section of a page.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "components/model/report/section.h"
#include "reproduction/network_tables/comparison.h"

namespace sinew::reproduction {

// "table 6.2", "table 6.4", "cylinder".
const char* TableName(networks::Task task);

std::string FormatComparison(const ComparisonResult& result);
// The tables, the order and a picture (Figs 6.6, 6.8) for a page of results.
report::Section ComparisonSection(const ComparisonResult& result);
nlohmann::ordered_json ComparisonJson(const ComparisonResult& result);

// Sentences: data, normalisation, inputs; where our order is another one than the published, and
// why.
std::vector<std::string> ComparisonParagraphs(const ComparisonResult& result);

}  // namespace sinew::reproduction
