// The declared terms of a model fitted as they are reported (reported.h): priors of their
// tolerances, one noise for all rows, intervals by blocks.
#pragma once

#include "components/model/trace/whitened_fit.h"

namespace sinew::trace {

inline identify::FitResult PlainFit(const identify::Design& design,
                                    const actuator::JointModel& model) {
  constexpr int kPasses = 5;  // priors weigh against what the pass before left
  Likelihood likelihood;
  likelihood.used = MakeUsedRows(design, 10);
  identify::FitResult fit;
  Eigen::VectorXd left = identify::ErrorOf(design, model).residual(likelihood.used.rows);
  for (int pass = 0; pass < kPasses; ++pass) {
    likelihood = Unweighted(std::move(likelihood), left);
    fit = FitWhitened(design, likelihood, model);
    left = LeftOver(fit, likelihood.used);
  }
  return fit;
}

}  // namespace sinew::trace
