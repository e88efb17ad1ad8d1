// Detectable sizes of these recordings: the smallest size of every effect that the search would
// have found, and the effects that could hide. Pure; allocates.
#pragma once

#include <optional>
#include <vector>

#include "components/model/trace/problem.h"
#include "components/model/trace/trace_result.h"

namespace sinew::trace {

// Misfit that a hypothesis has to take away before two rules of the search accept it alone:
// p_global (`statistic`: the least one that reaches its limit, null_test.h) and what it has to
// explain, of the misfit (RuleOfShare of hypotheses.h) or, whichever is less, of the variance.
// misfit: of the declared terms, without the effect; occam: of its columns (Evidence); by_variance:
// misfit that goes with the variance (LeastVariance).
double NeededGain(const Hypothesis& hypothesis, double misfit, double occam, double statistic,
                  double by_variance, const InForce& in_force);

// Size, in standard errors of its coefficient, at which an effect takes away `needed` in 80 % of
// recordings. The gain of k columns is noncentral chi-square with k degrees of freedom, here by its
// normal approximation. other: apparent size, in the same unit, of what the recording contains
// besides noise that resembles the effect; it adds to the effect or takes from it, equally likely.
// An effect of which less than `other` would remain is found with the wrong sign: not at all.
double SizeForPower(double needed, int columns, double other);

// Coefficient of column j of a hypothesis from which on both are reached, for an effect that is not
// exactly its column; none: the declared terms carry the column. by_variance: coefficient that goes
// with the variance; other: as of SizeForPower.
std::optional<double> DetectableCoefficient(const Problem& problem, const Hypothesis& hypothesis,
                                            Eigen::Index j, double statistic, double by_variance,
                                            double other);

// For every effect and each of its linear parameters, at the shape that shows best (size over
// what matters to the torque, or over what machines have, whichever is more); effects that
// the declared terms absorb apart, and those that are lines of a spectrum, which is searched and
// has no size beforehand. found: what is there; other effects are fitted beside it.
std::vector<DetectableSize> FindDetectable(const Problem& problem,
                                           const actuator::JointModel& declared, double statistic,
                                           const EffectSet& found);

// Notes the effects that the recordings could not have shown, by result->detectable, and those that
// they could. What they do show (found or open) would have been sure to be found, whatever its
// size.
void NoteSensitivity(const Problem& problem, TraceResult* result);

}  // namespace sinew::trace
