// Values with 95 % intervals from trials, and least squares whose rows belong to trials.
// Pure; allocates; throws std::invalid_argument for fewer trials than it needs.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace sinew::experiment {

struct Estimate {
  double value = 0.0;
  double half_width_95 = 0.0;
  int trials = 0;
  bool Covers(double truth) const {
    return truth >= value - half_width_95 && truth <= value + half_width_95;
  }
};

// Student's interval of the mean of independent trials; at least 2.
Estimate MeanOfTrials(const std::vector<double>& values);

// Least squares y = X b. Rows of one trial may be correlated in any way, trials are independent:
// cluster-robust covariance (identify/block_regression.h) and Student's quantile at trials - p.
struct TrialFit {
  Eigen::VectorXd b;
  Eigen::MatrixXd covariance;
  int trials = 0;
  double residual_sd = 0.0;

  Estimate At(Eigen::Index i) const;
  // Of a function of b with this gradient.
  Estimate Of(double value, const Eigen::Ref<const Eigen::VectorXd>& gradient) const;
};
// trial: number of the trial of each row, 0 .. n-1.
TrialFit FitTrials(const Eigen::Ref<const Eigen::MatrixXd>& X,
                   const Eigen::Ref<const Eigen::VectorXd>& y, const std::vector<int>& trial);

// Straight line y = a + b x through points; b first for slopes is at index 1.
struct Line {
  double at_zero = 0.0;
  double slope = 0.0;
};
Line FitLine(const std::vector<double>& x, const std::vector<double>& y);

}  // namespace sinew::experiment
