// A balance ready for the search: its rows, whitened, with everything that may explain what the
// declared terms leave. Made once; only CompareBands changes it. Pure; allocates.
#pragma once

#include "components/model/identify/balance.h"
#include "components/model/trace/evidence.h"
#include "components/model/trace/hypotheses.h"
#include "components/model/trace/set_search.h"
#include "components/model/trace/whitened_fit.h"

namespace sinew::trace {

struct Problem {
  Bank bank;
  Eigen::MatrixXd X, Z;  // declared columns and bank, whitened
  Eigen::VectorXd y;
  double scale = 1.0;  // torque per unit of the balance
  Evidence evidence;
  double variance = 0.0;  // squares that the declared terms leave by least squares, not whitened
  // Precision of the declared columns where their tolerances are as good as measurements (links
  // that were weighed): it counts in those least squares too. Empty: stated roughly, flat there.
  Eigen::VectorXd plain_precision = {};
  // The measured side where the target is only what a fit left of it: its rms, and the highest
  // torque. 0: the target's own.
  double measured_rms = 0.0, measured_peak = 0.0;

  const std::vector<Hypothesis>& hypotheses() const { return bank.hypotheses; }
  Choices choices() const { return {evidence, bank.hypotheses}; }
  const InForce& in_force() const { return bank.in_force; }
  // Whitened residual with a set in the model.
  Eigen::VectorXd Left(const EffectSet& set) const;
  // The same with every block predicted by a fit without it (jackknife; CR3 of Bell, McCaffrey
  // 2002): what a flexible set fits of a block alone stays in it. As long as y, zero between
  // blocks.
  Eigen::VectorXd LeftOut(const EffectSet& set, const std::vector<identify::Block>& blocks) const;
  // Contribution of a set, not whitened.
  Eigen::VectorXd Part(const EffectSet& set) const;
  // Residual of `rest` by least squares with the declared terms, not whitened.
  Eigen::VectorXd LeftPlain(const Eigen::VectorXd& rest) const;
  // Share of the raw residual's variance that a set takes away, the declared terms refitted by
  // least squares with and without it. May be negative.
  double VarianceShare(const EffectSet& set) const;
};

// Rows of a block at least.
inline constexpr int kFewestRowsPerBlock = 20;
// Rows over which the noise may be coloured: two periods of the angles' low-pass, 6 to 40.
int LongestOrder(double rows_per_period);
int LongestOrder(const identify::Design& design);

// The noise by a residual at the used rows: one scale a recording; but chambers and encoders are
// loud where a valve opens or a tooth touches.
void LearnNoise(const identify::Design& design, const Eigen::Ref<const Eigen::VectorXd>& residual,
                effects::Balance balance, Likelihood* likelihood);

// Residual with everything in the model, not whitened: noise.
Eigen::VectorXd Richest(const Problem& problem);

// fit: of the declared terms; the design's drive must be predicted by it.
Problem MakeProblem(const identify::Design& design, const Likelihood& likelihood,
                    const actuator::JointModel& declared, const identify::FitResult& fit);

// Rows and noise of a balance, and the declared terms fitted with them.
struct LikelihoodFit {
  Likelihood likelihood;
  identify::FitResult fit;
  double richest_rms = 0.0;  // what the richest model leaves
};

// The noise is that of the richest model: two passes, and rows far outside of it are left out. The
// design's predicted drive follows the fit.
LikelihoodFit EstimateLikelihood(identify::Design* design, const actuator::JointModel& declared,
                                 const InForce& in_force);

// The size of an effect does not depend on a filter, that of what a low-pass of the angles cuts
// off, or lets through of the noise, does. Effects identified from rates that are as large behind
// the other one are steady; all others count as much as there, where that is less. other: the same
// recordings. Returns its rows and noise.
Likelihood CompareBands(identify::Design* other, const actuator::JointModel& declared,
                        Problem* problem);

// The declared model with the terms of a set of effects. terms: numbers of those of each member of
// the set, in the model that is returned. Sizes are those of the set's fit, in physical units.
actuator::JointModel ModelWith(const actuator::JointModel& declared, const Problem& problem,
                               const EffectSet& set, std::vector<std::vector<int>>* terms);

}  // namespace sinew::trace
