// Sizes of a set of effects by plain least squares with the priors of the declared tolerances, and
// what a model leaves of each row of the balance. Pure; allocates.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "components/model/stance_fit/stance_problem.h"

namespace sinew::stance_fit {

// Declared columns and a set. What is left is correlated over time and over channels, so that its
// squares overstate what is known: they are divided by the dispersion, the mean over the columns of
// the variance of their scores over that of white noise (quasi-likelihood; McCullagh, Nelder:
// Generalized Linear Models (1989), 9). Else priors would count too little beside the data.
struct PlainFit {
  Eigen::VectorXd b;           // declared, then the set's
  Eigen::MatrixXd covariance;  // of the scores of long blocks
  double quantile = 0.0;       // Student's, 97.5 %
  double dispersion = 1.0;     // at least 1

  double HalfWidth(Eigen::Index i) const {
    return quantile * std::sqrt(std::max(0.0, covariance(i, i)));
  }
};

// A payload sits on what carries it: given its mass m, each of its first moments about the middle
// of its group has a normal prior of zero mean, with m times the group's size as the deviation.
struct PlacePrior {
  Eigen::Index first = 0;  // of the set's columns: mass, then first moments
  int moments = 2;
  double size_m = 0.0;
};

PlainFit FitPlain(const Regression& regression, const trace::Columns& columns,
                  const std::vector<PlacePrior>& places = {});

// Residual of the regression's stacked rows after a fit; fit.b as long as the declared columns and
// `columns` together.
Eigen::VectorXd Left(const Regression& regression, const PlainFit& fit,
                     const trace::Columns& columns);

// From the set's column `first` of the fit on: mass, then first moments along the group's axes. An
// axis that does not show leaves the place at the group's middle, give or take its size.
PlacedPayload PayloadOf(const PlainFit& fit, Eigen::Index first, const RigidGroup& group);

// Residual of each of the layout's rows once the forces that no sensor measures took what fits them
// best: e = W^-2 project' r, project = N' W and r the stacked rest. Used rows x layout rows,
// N or Nm.
Eigen::MatrixXd RestOfRows(const StanceLayout& layout, const std::vector<StanceRows>& recordings,
                           const Eigen::Ref<const Eigen::VectorXd>& rest);

StanceError ErrorOf(const StanceLayout& layout, const std::vector<StanceRows>& recordings,
                    const Eigen::Ref<const Eigen::VectorXd>& rest);

}  // namespace sinew::stance_fit
