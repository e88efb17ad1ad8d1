// How much of a residual an effect makes, and whether a test for the known effect would detect it.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "bench/rigs/drawn/declared.h"

namespace sinew::rigs {

// Residual of the declared model after least squares over its columns.
Eigen::VectorXd RefitResidual(const Balance& balance);

// Places that both hold, as indices into each.
struct Common {
  std::vector<Eigen::Index> left, right;
};
Common CommonRows(const std::vector<int>& left, const std::vector<int>& right);

// AR coefficients (Yule-Walker) of a residual over stretches of adjacent rows.
Eigen::VectorXd FitAr(const Eigen::VectorXd& residual, const std::vector<int>& row, int order);
// Applies them within stretches; the first rows of each are left out (their places too, if given).
Eigen::MatrixXd Whiten(const Eigen::MatrixXd& values, const std::vector<int>& row,
                       const Eigen::VectorXd& ar);

// The test: response = columns theta + s signature + AR noise, declared tolerances as priors on
// theta. Lambda is the noncentrality of the square of the t of s at s = 1; chi-squared with one
// degree of freedom exceeds its 99th percentile with 95 % power at 17.8.
inline constexpr double kIdentifiableLambda = 17.8;
inline constexpr int kArOrder = 6;
double Lambda(const Balance& balance, const Eigen::VectorXd& signature, bool with_priors);

// Share of the energy of one signature that the best fit of the others (together) leaves, both
// freed of the columns and whitened alike.
double LossOfFit(const Balance& balance, const Eigen::VectorXd& signature,
                 const Eigen::MatrixXd& others, const Eigen::VectorXd& ar);

}  // namespace sinew::rigs
