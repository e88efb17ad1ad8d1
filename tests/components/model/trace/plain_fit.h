// The declared terms of a model fitted as they are reported (reported.h): priors of their
// tolerances, one noise for all rows, intervals by blocks.
#pragma once

#include "components/model/trace/whitened_fit.h"

namespace sinew::trace {

inline identify::FitResult PlainFit(const identify::Design& design,
                                    const actuator::JointModel& model) {
  Likelihood likelihood;
  likelihood.used = MakeUsedRows(design, 10);
  const Eigen::VectorXd nominal = identify::ErrorOf(design, model).residual(likelihood.used.rows);
  likelihood = Unweighted(std::move(likelihood), nominal);
  const identify::FitResult first = FitWhitened(design, likelihood, model);
  return FitWhitened(design, Unweighted(likelihood, LeftOver(first, likelihood.used)), model);
}

}  // namespace sinew::trace
