#include "components/model/trace/set_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace sinew::trace {

namespace {

// The number of families that lead pairs, and of pairs that lead triples.
constexpr std::size_t kLeadingFamilies = 12;
constexpr std::size_t kLeadingPairs = 8;

bool Joins(const Choices& choices, const EffectSet& set, std::size_t next) {
  return std::none_of(set.members.begin(), set.members.end(), [&](std::size_t member) {
    return choices.hypotheses[member].family == choices.hypotheses[next].family;
  });
}

EffectSet With(const Choices& choices, const EffectSet& set, std::size_t next) {
  std::vector<std::size_t> members = set.members;
  members.push_back(next);
  return FitSet(choices, std::move(members));
}

void SortByNet(std::vector<EffectSet>* sets) {
  std::stable_sort(sets->begin(), sets->end(),
                   [](const EffectSet& a, const EffectSet& b) { return a.net > b.net; });
}

}  // namespace

EffectSet FitSet(const Choices& choices, std::vector<std::size_t> members) {
  EffectSet out;
  double charge = 0.0;
  for (const std::size_t member : members) {
    const Hypothesis& h = choices.hypotheses[member];
    out.columns.insert(out.columns.end(), h.columns.begin(), h.columns.end());
    charge += h.charge;
  }
  out.members = std::move(members);
  if (out.columns.empty()) return out;
  out.c = choices.evidence.Solve(out.columns);
  out.gain = choices.evidence.Gain(out.columns);
  out.net = out.gain - choices.evidence.Occam(out.columns) - charge;
  return out;
}

bool Physical(const Choices& choices, const EffectSet& set) {
  Eigen::MatrixXd covariance;
  Eigen::Index k = 0;
  for (const std::size_t member : set.members) {
    const Hypothesis& h = choices.hypotheses[member];
    for (std::size_t i = 0; i < h.columns.size(); ++i, ++k) {
      const double value = set.c[k];
      if (value >= h.lower[i] && value <= h.upper[i]) continue;
      if (h.columns.size() < 2) return false;
      if (covariance.size() == 0) covariance = choices.evidence.Covariance(set.columns);
      const double off = 2.0 * std::sqrt(std::max(0.0, covariance(k, k)));
      if (value < h.lower[i] - off || value > h.upper[i] + off) return false;
    }
  }
  return true;
}

double TimesOutOfRange(const std::vector<Hypothesis>& hypotheses, const EffectSet& set) {
  double out = 1.0;
  Eigen::Index k = 0;
  for (const std::size_t member : set.members) {
    const Hypothesis& h = hypotheses[member];
    for (std::size_t i = 0; i < h.columns.size(); ++i, ++k) {
      const double value = set.c[k];
      if (value >= h.lower[i] && value <= h.upper[i]) continue;
      const double bound = value < h.lower[i] ? h.lower[i] : h.upper[i];
      const double times = value / bound;
      constexpr double kBeyondZero = std::numeric_limits<double>::infinity();
      out = std::max(out, bound != 0.0 && times > 1.0 ? times : kBeyondZero);
    }
  }
  return out;
}

SetSearch SearchSets(const Choices& choices, std::size_t largest,
                     const std::set<std::string>& refuted) {
  const auto asked = [&](std::size_t h) {
    return choices.hypotheses[h].asked == Asked::kSearched &&
           !refuted.contains(choices.hypotheses[h].name);
  };
  SetSearch out;
  out.best.emplace_back();
  std::map<int, EffectSet> by_family, out_of_range;
  for (std::size_t h = 0; h < choices.hypotheses.size(); ++h) {
    if (!asked(h)) continue;
    EffectSet single = FitSet(choices, {h});
    if (!choices.hypotheses[h].physical()) {
      if (out.curve.empty() || single.net > out.curve.net) out.curve = std::move(single);
      continue;
    }
    const bool physical = Physical(choices, single);
    EffectSet& best = (physical ? by_family : out_of_range)[choices.hypotheses[h].family];
    if (best.empty() || single.net > best.net) best = std::move(single);
  }
  for (auto& [family, single] : out_of_range) {
    if (!by_family.contains(family)) out.out_of_range.push_back(std::move(single));
  }
  SortByNet(&out.out_of_range);
  for (auto& [family, single] : by_family) out.singles.push_back(std::move(single));
  SortByNet(&out.singles);
  if (out.singles.empty() || largest < 1) return out;
  out.best.push_back(out.singles.front());

  std::vector<EffectSet> leading(out.singles.begin(),
                                 out.singles.begin() + static_cast<std::ptrdiff_t>(std::min(
                                                           kLeadingFamilies, out.singles.size())));
  for (std::size_t size = 2; size <= largest; ++size) {
    std::vector<EffectSet> next;
    for (const EffectSet& set : leading) {
      for (std::size_t h = 0; h < choices.hypotheses.size(); ++h) {
        if (!choices.hypotheses[h].physical() || !asked(h) || !Joins(choices, set, h)) continue;
        EffectSet joined = With(choices, set, h);
        if (Physical(choices, joined)) next.push_back(std::move(joined));
      }
    }
    if (next.empty()) break;
    SortByNet(&next);
    // The same families come in either order and with many settings: the best of each is enough.
    std::vector<EffectSet> distinct;
    std::vector<std::vector<int>> seen;
    for (EffectSet& set : next) {
      std::vector<int> families;
      for (const std::size_t member : set.members)
        families.push_back(choices.hypotheses[member].family);
      std::sort(families.begin(), families.end());
      if (std::find(seen.begin(), seen.end(), families) != seen.end()) continue;
      seen.push_back(std::move(families));
      distinct.push_back(std::move(set));
      if (distinct.size() >= kLeadingPairs) break;
    }
    // The first member's setting was the best alone: it is profiled again beside the others.
    EffectSet best = WithShapesBeside(choices, distinct.front());
    out.best.push_back(std::move(best));
    leading = std::move(distinct);
  }
  return out;
}

EffectSet WithoutMember(const Choices& choices, const EffectSet& set, std::size_t k) {
  std::vector<std::size_t> others = set.members;
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
  return FitSet(choices, std::move(others));
}

EffectSet WithShapesBeside(const Choices& choices, EffectSet set) {
  for (std::size_t k = 0; k < set.members.size(); ++k) {
    for (std::size_t h = 0; h < choices.hypotheses.size(); ++h) {
      if (choices.hypotheses[h].family != choices.hypotheses[set.members[k]].family) continue;
      std::vector<std::size_t> members = set.members;
      members[k] = h;
      EffectSet other = FitSet(choices, std::move(members));
      if (other.net > set.net && Physical(choices, other)) set = std::move(other);
    }
  }
  return set;
}

EffectSet WithBestCurve(const Choices& choices, const EffectSet& set) {
  EffectSet best;
  for (std::size_t h = 0; h < choices.hypotheses.size(); ++h) {
    if (choices.hypotheses[h].physical()) continue;
    EffectSet joined = With(choices, set, h);
    if (best.empty() || joined.net > best.net) best = std::move(joined);
  }
  return best;
}

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

}  // namespace sinew::trace
