// The best explanation by one, two or three effects of the catalogue, and by one free curve.
//
// Subsets are compared jointly by their net gain: twice the logarithm of the ratio of marginal
// likelihoods (evidence.h) less what their profiled shapes and searches are charged. Every member
// has to stay inside its physical range in the joint fit. Singles are compared over the whole bank;
// pairs join the leading families with everything; triples the leading pairs with everything. Pure;
// allocates.
#pragma once

#include <Eigen/Core>
#include <set>
#include <string>
#include <vector>

#include "components/model/trace/evidence.h"
#include "components/model/trace/hypotheses.h"

namespace sinew::trace {

// Parts that sets are made of.
struct Choices {
  const Evidence& evidence;
  const std::vector<Hypothesis>& hypotheses;
};

struct EffectSet {
  std::vector<std::size_t> members;  // of the bank's hypotheses
  Columns columns;
  Eigen::VectorXd c;
  double gain = 0.0;  // misfit taken away
  double net = 0.0;   // of the marginal likelihood, less the charges

  bool empty() const { return members.empty(); }
};

// Joint fit of some hypotheses.
EffectSet FitSet(const Choices& choices, std::vector<std::size_t> members);

// The set refitted without its k-th member.
EffectSet WithoutMember(const Choices& choices, const EffectSet& set, std::size_t k);

// Inside the physical range? Several parameters of one effect may leave it by two standard errors:
// one of them may hardly be excited.
bool Physical(const Choices& choices, const EffectSet& set);

// The largest coefficient over the bound that it exceeds; infinite where the bound is zero, 1 where
// all are inside.
double TimesOutOfRange(const std::vector<Hypothesis>& hypotheses, const EffectSet& set);

// Effects of a set at most.
inline constexpr std::size_t kLargestSet = 3;

struct SetSearch {
  std::vector<EffectSet> best;     // of size 0, 1, 2, 3; best.size() - 1 sizes were possible
  std::vector<EffectSet> singles;  // best setting of every family, physical ones only, best first
  // The same of the families that have no setting inside its physical range.
  std::vector<EffectSet> out_of_range;
  EffectSet curve;  // best free curve alone; may be empty
};

// largest: of a set, at most 3. refuted: names of effects that are excluded.
SetSearch SearchSets(const Choices& choices, std::size_t largest,
                     const std::set<std::string>& refuted = {});

// The set with the shape of every member chosen anew beside the others, each among the settings of
// its own family.
EffectSet WithShapesBeside(const Choices& choices, EffectSet set);

// The free curve that gains most beside a set; the set with it.
EffectSet WithBestCurve(const Choices& choices, const EffectSet& set);

// The set that is given by name, no rule applied: the hypothesis of each effect, jointly the ones
// that gain most. Effects without a physical hypothesis are left out.
EffectSet FitAgreedSet(const Choices& choices, const std::set<std::string>& effects);

}  // namespace sinew::trace
