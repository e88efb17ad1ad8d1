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
// the covariance is that of leaving out one trial after the other,
//
//     V = (n - 1) / n sum (b_without_i - b)(b_without_i - b)'
//
// which holds for few trials of unequal weight too, where the usual sandwich is too narrow
// (MacKinnon, Nielsen, Webb: J. Econometrics 232 (2023) 272, CV3); Student's quantile at trials -
// p.
struct TrialFit {
  Eigen::VectorXd b;
  Eigen::MatrixXd covariance;
  int trials = 0;

  Estimate At(Eigen::Index i) const;
  // Estimate of a function of b with this gradient.
  Estimate Of(double value, const Eigen::Ref<const Eigen::VectorXd>& gradient) const;
};
// Columns that are measured with noise of their own bias least squares toward 0. Instruments Z, a
// second measurement of the columns whose noise is independent of the first, do not: (Z'X) b = Z'y
// (Soderstrom, Stoica: System Identification, ch. 8). Z is X where a column has no noise.
// trial: number of the trial of each row, 0 .. n-1.
TrialFit FitTrials(const Eigen::Ref<const Eigen::MatrixXd>& X,
                   const Eigen::Ref<const Eigen::MatrixXd>& Z,
                   const Eigen::Ref<const Eigen::VectorXd>& y, const std::vector<int>& trial);

// Rows of such a regression, one by one; trials rise.
class TrialRows {
 public:
  void Add(int trial, const Eigen::VectorXd& x, double y) { Add(trial, x, x, y); }
  void Add(int trial, const Eigen::VectorXd& x, const Eigen::VectorXd& z, double y);
  std::size_t size() const { return y_.size(); }
  int trials() const { return trial_.empty() ? 0 : trial_.back() + 1; }
  TrialFit Fit() const;

 private:
  std::vector<Eigen::VectorXd> x_, z_;
  std::vector<double> y_;
  std::vector<int> trial_;
};

// Largest error that rounding to counts leaves in the mean of many rows of a value that stands
// still: with noise of variance sigma^2 and a count c, (c / pi) exp(-2 pi^2 sigma^2 / c^2) (Widrow,
// Kollar: Quantization Noise, ch. 4). variance: of the rounded rows, from which sigma^2 is
// estimated (Sheppard).
double LargestRounding(double variance, double count);

// Slope of the straight line through points; 0 where all have the same x.
double SlopeOf(const std::vector<double>& x, const std::vector<double>& y);

}  // namespace sinew::experiment
