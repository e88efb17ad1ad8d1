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

// Verdict on an effect by the score of its facts, unless something refuses it.
void Assess(const Facts& facts, const std::optional<Refusal>& refusal, const InForce& in_force,
            FoundEffect* found);

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

// Held-out confirmation of an effect, by a test that is fixed before it is run.
//
// The model without the effect and the model with it are fitted to the training recordings. On the
// held-out ones r is what the first leaves and d the change that the second predicts, both
// whitened. The slope of r on d is 1 for an effect that is there with the size that training gave
// it, 0 for one that is not, negative for one that makes the prediction worse:
//
//     s = d'r / d'd,   standard error from the scores d_b'(r_b - s d_b) of blocks b
//
// A fixed share of the training gain would be wrong: the held-out motion may excite the effect
// less.
//
// From whitened left-over and predicted change; no interval from fewer blocks than the rule
// held_out_blocks asks for.
Confirmation ConfirmSlope(const Eigen::Ref<const Eigen::VectorXd>& left_over,
                          const Eigen::Ref<const Eigen::VectorXd>& change,
                          const std::vector<identify::Block>& blocks, const InForce& in_force);

// without, with: fitted to the training recordings, of the same declared terms; the drive of
// held_out must be predicted by `with`.
Confirmation ConfirmSlope(const identify::Design& held_out, const identify::FitResult& without,
                          const identify::FitResult& with, const InForce& in_force);

}  // namespace sinew::trace
