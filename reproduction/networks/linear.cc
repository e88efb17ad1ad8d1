#include "reproduction/networks/linear.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <stdexcept>

namespace sinew::networks {
namespace {

Eigen::VectorXd Regressors(const Samples& samples, const std::vector<int>& inputs, int taps,
                           int t) {
  Eigen::VectorXd x(static_cast<Eigen::Index>(inputs.size()) * taps);
  Eigen::Index k = 0;
  for (int n = 0; n < taps; ++n) {
    const int from = std::max(t - n, samples.first[static_cast<std::size_t>(t)]);
    for (const int row : inputs) x(k++) = samples.inputs(row, from);
  }
  return x;
}

}  // namespace

Eigen::VectorXd LinearModel::Predict(const Samples& samples) const {
  Eigen::VectorXd y(samples.count());
  for (int t = 0; t < samples.count(); ++t) {
    y(t) = coefficients.dot(Regressors(samples, inputs, taps, t));
  }
  return y;
}

LinearModel FitLinear(const Samples& samples, const std::vector<int>& inputs, int taps,
                      double beta) {
  const bool known = std::all_of(inputs.begin(), inputs.end(),
                                 [&](int row) { return row >= 0 && row < samples.inputs.rows(); });
  if (inputs.empty() || !known || taps < 1 || samples.targets.rows() != 1 || !(beta >= 0.0)) {
    throw std::invalid_argument(
        "linear model: expected inputs that are there, at least one tap, one target, beta >= 0");
  }
  const Eigen::Index size = static_cast<Eigen::Index>(inputs.size()) * taps;
  Eigen::MatrixXd left = beta * Eigen::MatrixXd::Identity(size, size);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(size);
  for (const int t : samples.train) {
    const Eigen::VectorXd x = Regressors(samples, inputs, taps, t);
    left += x * x.transpose();
    right += x * samples.targets(0, t);
  }
  return {inputs, taps, left.ldlt().solve(right)};
}

}  // namespace sinew::networks
