#include "components/model/trace/agreed_set.h"

#include <algorithm>
#include <utility>

namespace sinew::trace {

EffectSet FitAgreedSet(const Choices& choices, const std::set<std::string>& effects) {
  EffectSet out;
  for (const std::string& name : effects) {
    EffectSet best;
    const bool searched =
        std::any_of(choices.hypotheses.begin(), choices.hypotheses.end(), [&](const Hypothesis& h) {
          return h.physical() && h.name == name && h.asked == Asked::kSearched;
        });
    for (std::size_t h = 0; h < choices.hypotheses.size(); ++h) {
      if (!choices.hypotheses[h].physical() || choices.hypotheses[h].name != name) continue;
      if (searched && choices.hypotheses[h].asked != Asked::kSearched) continue;
      std::vector<std::size_t> members = out.members;
      members.push_back(h);
      EffectSet joined = FitSet(choices, std::move(members));
      if (!Physical(choices, joined)) continue;
      if (best.empty() || joined.net > best.net) best = std::move(joined);
    }
    if (!best.empty()) out = std::move(best);
  }
  return WithShapesBeside(choices, std::move(out));
}

std::set<std::string> Unasked(const Problem& problem,
                              const std::optional<std::set<std::string>>& agreed) {
  std::set<std::string> out;
  if (!agreed) return out;
  for (const Hypothesis& h : problem.hypotheses()) {
    if (h.physical() && agreed->count(h.name) == 0) out.insert(h.name);
  }
  return out;
}

void ChooseAgreed(const Problem& problem, std::set<std::string> agreed,
                  const std::set<std::string>& refuted, SetAssessment* assessed) {
  for (const std::string& name : refuted) agreed.erase(name);
  assessed->chosen = FitAgreedSet(problem.choices(), agreed);
  assessed->posteriors.clear();  // the rotations have them
  for (const std::size_t member : assessed->chosen.members) {
    assessed->posteriors.push_back({{problem.hypotheses()[member].name, 1.0}});
  }
}

}  // namespace sinew::trace
