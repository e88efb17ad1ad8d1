// Two facts of a member of a set that training chose, and the score that is made of them.
//
//     p = 1 / (1 + exp(-(2.0 - 2.4 curve - 3.3 |1 - slope|)))
//
// curve: what the best free curve gains beside the set, share of the set's own evidence. slope: of
// the held-out residual on the contribution that training predicts there, with the imperfections of
// that recording fitted beside it. The weights are a prototype's, trained on simulated rigs of two
// kinds. Pure; allocates.
#pragma once

#include <optional>

#include "components/model/trace/confirmation.h"
#include "components/model/trace/problem.h"
#include "components/model/trace/trace_result.h"

namespace sinew::trace {

struct Facts {
  double curve = 0.0;
  // Held out; none: no row shows it, or it began at an instant, which FactsOf does not know there.
  std::optional<double> slope;
  double error = 0.0;  // of the slope, one standard deviation
  int blocks = 0;      // of the held-out recordings

  // Fewer standard errors than these a slope of one says nothing.
  bool Assessed() const { return slope && error < 1.0 / kLeastExpected; }
  double Score() const;
  // Slope, error and blocks of a confirmation, and as one, without a verdict.
  void SetSlope(const Confirmation& confirmation);
  Confirmation AsConfirmation() const;

  static constexpr double kLeastExpected = 2.5;
};

// Gain of the best free curve beside a set, share of the set's.
double CurveBeside(const Problem& problem, const EffectSet& set);

// An encoder without an absolute zero comes back turned after every start, and the map of the
// motor's shaft with it: where lines of member k, two at least (one alone can be turned to fit
// anything), explain more of a held-out recording by another zero, the design gets that zero.
std::vector<ZeroTurn> FindZeroTurns(const Problem& problem, const EffectSet& set, std::size_t k,
                                    const identify::FitResult& declared_fit,
                                    const Likelihood& train, identify::Design* held_out);

// Facts of member k without the curve. held_out: its drive predicted by the fit in training.
Facts FactsOf(const Problem& problem, const EffectSet& set, std::size_t k,
              const identify::Design& held_out, const identify::FitResult& declared_fit,
              const Likelihood& train);

}  // namespace sinew::trace
