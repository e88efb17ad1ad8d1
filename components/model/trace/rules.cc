#include "components/model/trace/rules.h"

#include <array>

#include "components/base/types/text.h"

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
    out += "| `" + std::string(rule.id) + "` | " + rule.statistic + " | " +
           types::Text("%.3g", rule.limit) + " | " + rule.source + " |\n";
  }
  return out;
}

}  // namespace sinew::trace
