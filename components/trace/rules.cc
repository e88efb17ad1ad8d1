#include "components/trace/rules.h"

#include <array>
#include <cstdio>

namespace sinew::trace {

std::span<const Rule> AllRules() {
  static constexpr std::array kAll = {
      rules::kBlocks,         rules::kRows,        rules::kHeldOutBlocks, rules::kGlobalP,
      rules::kExplainedShare, rules::kSurprise,    rules::kShapeMisfit,   rules::kMemberP,
      rules::kCurveShare,     rules::kClearlyMore, rules::kConstancy,     rules::kSameClass,
      rules::kDetectable,     rules::kAbsorbed,    rules::kSlopeBand,     rules::kRefutedBelow,
      rules::kInterval,       rules::kRaises,      rules::kEventPeak,     rules::kEventAlone};
  return kAll;
}

std::string FormatRules() {
  std::string out =
      "| rule | statistic | limit | where the limit comes from |\n| --- | --- | --- | --- |\n";
  for (const Rule& rule : AllRules()) {
    char limit[32];
    std::snprintf(limit, sizeof limit, "%.3g", rule.limit);
    out += "| `" + std::string(rule.id) + "` | " + rule.statistic + " | " + limit + " | " +
           rule.source + " |\n";
  }
  return out;
}

}  // namespace sinew::trace
