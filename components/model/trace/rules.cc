#include "components/model/trace/rules.h"

#include <array>
#include <cstdio>

namespace sinew::trace {

std::span<const Rule> AllRules() {
  static constexpr std::array kAll = {
      rules::kBlocks,         rules::kRows,          rules::kHeldOutBlocks, rules::kGlobalP,
      rules::kExplainedShare, rules::kVarianceShare, rules::kPriorPenalty,  rules::kShapeMisfit,
      rules::kCurveEvidence,  rules::kCurveShare,    rules::kRange,         rules::kDetectable,
      rules::kAbsorbed,       rules::kEvidence,      rules::kScore,         rules::kOpen,
      rules::kBeyondDrive,    rules::kInterval,      rules::kRaises,        rules::kRotations,
      rules::kEventPeak,      rules::kEventAlone};
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
