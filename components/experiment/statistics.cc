#include "components/experiment/statistics.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "components/identify/block_regression.h"
#include "components/identify/statistics.h"

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
                   const Eigen::Ref<const Eigen::VectorXd>& y, const std::vector<int>& trial) {
  const int trials = trial.empty() ? 0 : *std::max_element(trial.begin(), trial.end()) + 1;
  if (trials <= X.cols()) {
    throw std::invalid_argument(std::to_string(trials) + " trials, expected more than " +
                                std::to_string(X.cols()));
  }
  // Columns of very different size: fit in units of each column's root mean square.
  const Eigen::VectorXd scale =
      (X.colwise().squaredNorm() / static_cast<double>(X.rows())).cwiseSqrt().cwiseMax(1e-300);
  const Eigen::MatrixXd scaled = X * scale.cwiseInverse().asDiagonal();
  std::vector<identify::Block> blocks(static_cast<std::size_t>(trials));
  for (Eigen::Index i = 0; i < X.rows(); ++i) {
    blocks[static_cast<std::size_t>(trial[static_cast<std::size_t>(i)])].push_back(i);
  }
  std::vector<identify::Moments> moments;
  Eigen::MatrixXd G = Eigen::MatrixXd::Zero(X.cols(), X.cols());
  Eigen::VectorXd m = Eigen::VectorXd::Zero(X.cols());
  for (const identify::Block& block : blocks) {
    moments.push_back(identify::MomentsOf(block, scaled, y));
    G += moments.back().G;
    m += moments.back().m;
  }
  TrialFit fit;
  fit.trials = trials;
  const Eigen::VectorXd b = identify::Solve(G, m);
  fit.residual_sd = std::sqrt((y - scaled * b).squaredNorm() /
                              std::max<double>(1.0, static_cast<double>(X.rows() - X.cols())));
  fit.covariance = scale.cwiseInverse().asDiagonal() * identify::BlockCovariance(moments, b) *
                   scale.cwiseInverse().asDiagonal();
  fit.b = b.cwiseQuotient(scale);
  return fit;
}

Estimate TrialFit::Of(double value, const Eigen::Ref<const Eigen::VectorXd>& gradient) const {
  const double variance = gradient.dot(covariance * gradient);
  const double freedom = static_cast<double>(trials - b.size());
  return {value, identify::StudentQuantile(kUpper, freedom) * std::sqrt(std::max(0.0, variance)),
          trials};
}

Estimate TrialFit::At(Eigen::Index i) const { return Of(b(i), Eigen::VectorXd::Unit(b.size(), i)); }

Line FitLine(const std::vector<double>& x, const std::vector<double>& y) {
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
  const double slope = xx > 0.0 ? xy / xx : 0.0;
  return {mean_y - slope * mean_x, slope};
}

}  // namespace sinew::experiment
