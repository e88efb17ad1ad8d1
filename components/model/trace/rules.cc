#include "components/model/trace/rules.h"

#include <array>
#include <cstdio>
#include <set>
#include <stdexcept>

namespace sinew::trace {

namespace {

std::set<std::string, std::less<>>& Absent() {
  static std::set<std::string, std::less<>> ids;
  return ids;
}

std::set<std::string, std::less<>>& AbsentEffects() {
  static std::set<std::string, std::less<>> names;
  return names;
}

}  // namespace

void TakeOutEffect(std::string_view name) { AbsentEffects().emplace(name); }

bool HasEffect(std::string_view name) { return !AbsentEffects().contains(name); }

double Limit(const Rule& rule) {
  return !Absent().contains(std::string_view(rule.id)) ? rule.limit : rule.off;
}

Refusal RefusedBy(const Rule& rule, double value) { return {rule.id, value, Limit(rule)}; }

void TakeOut(std::string_view id) {
  std::string known;
  for (const Rule& rule : AllRules()) {
    if (rule.id == id) {
      Absent().emplace(id);
      return;
    }
    known += (known.empty() ? "" : ", ") + std::string(rule.id);
  }
  throw std::invalid_argument("no rule '" + std::string(id) + "', expected one of " + known);
}

std::vector<std::string> TakenOut() { return {Absent().begin(), Absent().end()}; }

std::span<const Rule> AllRules() {
  static constexpr std::array kAll = {
      rules::kBlocks,         rules::kRows,          rules::kHeldOutBlocks, rules::kGlobalP,
      rules::kExplainedShare, rules::kVarianceShare, rules::kPriorPenalty,  rules::kShapeMisfit,
      rules::kMemberP,        rules::kCurveEvidence, rules::kCurveShare,    rules::kRange,
      rules::kDetectable,     rules::kAbsorbed,      rules::kEvidence,      rules::kScore,
      rules::kOpen,           rules::kBeyondDrive,   rules::kInterval,      rules::kRaises,
      rules::kRotations,      rules::kEventPeak,     rules::kEventAlone};
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
