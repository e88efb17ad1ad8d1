#include "components/topics/node/cut_off.h"

namespace sinew::node {

const std::vector<CutOffRule>& CutOffRules() {
  static const std::vector<CutOffRule> kRules = {
      {"reference", 0.2, "the provider"},
      {"regime", 0.2, "the provider"},
      {"pneumatics", 0.2, "the provider"},
      {"residual", 0.2, "the provider"},
      {"esn", 0.3, "reference, regime"},
      {"control", 0.4, "reference, regime, esn"},
      {"rls", 0.7, "esn, control"},
      {"performance", 0.7, "reference"},
      {"", 0.4, "as control"},
  };
  return kRules;
}

const CutOffRule& CutOffOf(std::string_view component) {
  const std::vector<CutOffRule>& rules = CutOffRules();
  for (const CutOffRule& rule : rules) {
    if (rule.component == component) return rule;
  }
  return rules.back();
}

}  // namespace sinew::node
