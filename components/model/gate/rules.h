// The rules of the data gate: one table.
//
// A rule stops when its statistic exceeds its limit. Every statistic is a ratio of quantities of
// the same unit, or a count, so that it does not depend on the units of the recording. The table is
// printed in docs/data-gate.md; a test compares the two. Pure data.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace sinew::gate {

struct Rule {
  std::string_view id;         // name of the fault: --accept-fault, report.json
  std::string_view statistic;  // what is computed
  double limit = 0.0;          // it stops above this
  std::string_view limit_source;
};

// In the order in which they are applied.
std::span<const Rule> Rules();

// Throws std::invalid_argument naming the rules there are.
const Rule& FindRule(std::string_view id);

// The table in Markdown, as in docs/data-gate.md.
std::string FormatRules();

}  // namespace sinew::gate
