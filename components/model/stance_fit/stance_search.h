// Which set of effects the whitened rows of a standing robot show, by the rules of
// components/model/trace. Pure; allocates.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "components/model/stance_fit/stance_problem.h"
#include "components/model/trace/posterior.h"
#include "components/model/trace/set_search.h"

namespace sinew::stance_fit {

struct FoundSet {
  trace::EffectSet set;
  double p_global = 1.0, least_statistic = 0.0;
  std::string unexplained;  // variable that explains more than any effect; empty: none
  std::vector<double> p;    // of each member
  std::vector<trace::Posterior> posteriors;
};

// refuted: names of hypotheses that are not searched for.
FoundSet SearchEffects(const Regression& regression, const WhitenedProblem& problem,
                       const ChannelNoise& noise, const StanceOptions& options,
                       std::set<std::string> refuted);

}  // namespace sinew::stance_fit
