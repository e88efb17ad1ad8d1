#include "components/model/experiment/statistics.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "components/model/identify/statistics.h"

namespace sinew::experiment {
namespace {

constexpr double kUpper = 0.975;

}  // namespace

Estimate MeanOfTrials(const std::vector<double>& values) {
  const int n = static_cast<int>(values.size());
  if (n < 2) {
    throw std::invalid_argument(std::to_string(n) + " trials, expected at least 2");
  }
  const double sd = identify::StandardDeviation(values);
  return {identify::Mean(values), identify::StudentQuantile(kUpper, n - 1.0) * sd / std::sqrt(n),
          n};
}

TrialFit FitTrials(const Eigen::Ref<const Eigen::MatrixXd>& X,
                   const Eigen::Ref<const Eigen::MatrixXd>& Z,
                   const Eigen::Ref<const Eigen::VectorXd>& y, const std::vector<int>& trial) {
  const Eigen::Index p = X.cols();
  const int trials = trial.empty() ? 0 : *std::max_element(trial.begin(), trial.end()) + 1;
  if (trials <= p) {
    throw std::invalid_argument(std::to_string(trials) + " trials, expected more than " +
                                std::to_string(p));
  }
  // Columns of very different size: fit in units of each column's root mean square.
  const Eigen::VectorXd scale =
      (X.colwise().squaredNorm() / static_cast<double>(X.rows())).cwiseSqrt().cwiseMax(1e-300);
  const Eigen::MatrixXd scaled = X * scale.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd instrument = Z * scale.cwiseInverse().asDiagonal();
  const auto n = static_cast<std::size_t>(trials);
  std::vector<Eigen::MatrixXd> G(n, Eigen::MatrixXd::Zero(p, p));
  std::vector<Eigen::VectorXd> m(n, Eigen::VectorXd::Zero(p));
  for (Eigen::Index i = 0; i < X.rows(); ++i) {
    const auto t = static_cast<std::size_t>(trial[static_cast<std::size_t>(i)]);
    G[t].noalias() += instrument.row(i).transpose() * scaled.row(i);
    m[t] += instrument.row(i).transpose() * y(i);
  }
  Eigen::MatrixXd all_G = Eigen::MatrixXd::Zero(p, p);
  Eigen::VectorXd all_m = Eigen::VectorXd::Zero(p);
  for (std::size_t t = 0; t < n; ++t) {
    all_G += G[t];
    all_m += m[t];
  }
  TrialFit fit;
  fit.trials = trials;
  const Eigen::VectorXd b = all_G.completeOrthogonalDecomposition().solve(all_m);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(p, p);
  for (std::size_t t = 0; t < n; ++t) {
    const Eigen::MatrixXd rest = all_G - G[t];
    const Eigen::VectorXd change = rest.completeOrthogonalDecomposition().solve(all_m - m[t]) - b;
    covariance += change * change.transpose();
  }
  covariance *= (trials - 1.0) / trials;
  fit.covariance =
      scale.cwiseInverse().asDiagonal() * covariance * scale.cwiseInverse().asDiagonal();
  fit.b = b.cwiseQuotient(scale);
  return fit;
}

void TrialRows::Add(int trial, const Eigen::VectorXd& x, const Eigen::VectorXd& z, double y) {
  x_.push_back(x);
  z_.push_back(z);
  y_.push_back(y);
  trial_.push_back(trial);
}

TrialFit TrialRows::Fit() const {
  const auto n = static_cast<Eigen::Index>(y_.size());
  const Eigen::Index columns = x_.empty() ? 0 : x_.front().size();
  Eigen::MatrixXd X(n, columns), Z(n, columns);
  for (std::size_t i = 0; i < y_.size(); ++i) {
    X.row(static_cast<Eigen::Index>(i)) = x_[i];
    Z.row(static_cast<Eigen::Index>(i)) = z_[i];
  }
  return FitTrials(X, Z, Eigen::Map<const Eigen::VectorXd>(y_.data(), n), trial_);
}

double LargestRounding(double variance, double count) {
  const double noise = std::max(0.0, variance - count * count / 12.0);
  return count / std::numbers::pi *
         std::exp(-2.0 * std::numbers::pi * std::numbers::pi * noise / (count * count));
}

Estimate TrialFit::Of(double value, const Eigen::Ref<const Eigen::VectorXd>& gradient) const {
  const double variance = gradient.dot(covariance * gradient);
  const double freedom = static_cast<double>(trials - b.size());
  return {value, identify::StudentQuantile(kUpper, freedom) * std::sqrt(std::max(0.0, variance)),
          trials};
}

Estimate TrialFit::At(Eigen::Index i) const { return Of(b(i), Eigen::VectorXd::Unit(b.size(), i)); }

double SlopeOf(const std::vector<double>& x, const std::vector<double>& y) {
  const auto n = static_cast<double>(x.size());
  double mean_x = 0.0, mean_y = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    mean_x += x[i] / n;
    mean_y += y[i] / n;
  }
  double xx = 0.0, xy = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mean_x) * (x[i] - mean_x);
    xy += (x[i] - mean_x) * (y[i] - mean_y);
  }
  return xx > 0.0 ? xy / xx : 0.0;
}

}  // namespace sinew::experiment
