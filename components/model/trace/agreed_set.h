// The set of effects that is given by name: no rule is applied, only shapes are fitted. Pure.
#pragma once

#include <optional>
#include <set>
#include <string>

#include "components/model/trace/assessment.h"
#include "components/model/trace/set_search.h"

namespace sinew::trace {

// The hypothesis of each effect, jointly the ones that gain most. Effects without a physical
// hypothesis are left out.
EffectSet FitAgreedSet(const Choices& choices, const std::set<std::string>& effects);

// Effects of the problem that were not agreed on; without an agreement: none.
std::set<std::string> Unasked(const Problem& problem,
                              const std::optional<std::set<std::string>>& agreed);

// Replaces the selected set by the agreed set, without effects refuted since.
void ChooseAgreed(const Problem& problem, std::set<std::string> agreed,
                  const std::set<std::string>& refuted, SetAssessment* assessed);

}  // namespace sinew::trace
