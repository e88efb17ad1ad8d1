// Selects the set of effects, and the variable that the residual follows where no effect explains
// it.
//
// The search opens with one p-value. A set grows while what is added has evidence, more than the
// shape of the effects so far may leave, and is more than an imperfection that any machine has.
// What a free curve gains beside it, in every row, is "unexplained" over its variable. The limits
// are those of rules.h. Pure; allocates.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "components/model/trace/problem.h"
#include "components/model/trace/trace_result.h"

namespace sinew::trace {

struct SetAssessment {
  double p_global = 1.0;
  double least_statistic = 0.0;        // whose p is at most the limit of p_global
  EffectSet chosen;                    // may be empty
  std::vector<Posterior> posteriors;   // of every member
  Unexplained unexplained;             // variable empty: nothing
  std::vector<CandidateScore> scores;  // best first; those out of their range last
};

struct BootstrapOptions {
  int rounds = 999;
  int searches = 1;  // p_global is that of all of them together (Bonferroni)
  std::uint64_t seed = 1;
};

inline BootstrapOptions BootstrapOf(const TraceOptions& options) {
  constexpr int kRoundsOfSearch = 200;
  return {kRoundsOfSearch * options.searches, options.searches, options.seed};
}

// blocks: of the whitened rows; refuted: names of hypotheses that are excluded. agreed: no others
// are asked for, and the set that is selected is all of them, but for those.
SetAssessment AssessSets(const Problem& problem, const std::vector<identify::Block>& blocks,
                         effects::Balance balance, std::size_t largest_set,
                         const BootstrapOptions& bootstrap,
                         const std::set<std::string>& refuted = {},
                         const std::optional<std::set<std::string>>& agreed = {});

}  // namespace sinew::trace
