#include "components/model/identify/statistics.h"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <numeric>

namespace sinew::identify {

double StudentQuantile(double p, double freedom) {
  if (!(p > 0.0) || !(p < 1.0) || !(freedom > 0.0)) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  return boost::math::quantile(boost::math::students_t(freedom), p);
}

double Rms(const Eigen::Ref<const Eigen::VectorXd>& values) {
  return values.size() > 0 ? std::sqrt(values.squaredNorm() / static_cast<double>(values.size()))
                           : 0.0;
}

double Mean(const std::vector<double>& values) {
  if (values.empty()) return 0.0;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double StandardDeviation(const std::vector<double>& values) {
  if (values.size() < 2) return 0.0;
  const double mean = Mean(values);
  double sum = 0.0;
  for (const double value : values) sum += (value - mean) * (value - mean);
  return std::sqrt(sum / static_cast<double>(values.size() - 1));
}

double RobustDeviation(std::vector<double> values) {
  constexpr double kMedianSize = 0.67448975;  // of a standard normal value
  for (double& value : values) value = std::abs(value);
  return values.empty() ? 0.0 : Quantile(std::move(values), 0.5) / kMedianSize;
}

double Quantile(std::vector<double> values, double p) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const double at = p * static_cast<double>(values.size() - 1);
  const auto low = static_cast<std::size_t>(at);
  const std::size_t high = std::min(low + 1, values.size() - 1);
  return values[low] + (at - static_cast<double>(low)) * (values[high] - values[low]);
}

double Resolution(const Eigen::VectorXd& x) {
  std::vector<double> steps;
  const double least = 1e-12 * x.cwiseAbs().maxCoeff();
  for (Eigen::Index i = 1; i < x.size(); ++i) {
    const double step = std::abs(x[i] - x[i - 1]);
    if (step > least) steps.push_back(step);
  }
  if (steps.size() < 20) return steps.empty() ? 0.0 : *std::min_element(steps.begin(), steps.end());
  // Decimals of a file round by chance: the step is the low quantile, not the smallest.
  const double smallest = Quantile(steps, 0.02);
  const auto whole = std::count_if(steps.begin(), steps.end(), [&](double step) {
    const double ratio = step / smallest;
    return ratio < 40.0 ? std::abs(ratio - std::round(ratio)) < 0.1 : true;
  });
  const auto few = std::count_if(steps.begin(), steps.end(),
                                 [&](double step) { return step < 40.0 * smallest; });
  return 2 * few > static_cast<long>(steps.size()) / 2 &&
                 static_cast<double>(whole) > 0.95 * static_cast<double>(steps.size())
             ? smallest
             : 0.0;
}

double WhiteNoise(std::span<const Eigen::VectorXd> signals) {
  std::vector<double> size;
  for (const Eigen::VectorXd& x : signals) {
    for (Eigen::Index i = 0; i + 4 < x.size(); ++i) {
      size.push_back(x[i] - 4.0 * x[i + 1] + 6.0 * x[i + 2] - 4.0 * x[i + 3] + x[i + 4]);
    }
  }
  return RobustDeviation(std::move(size)) / std::sqrt(70.0);
}

}  // namespace sinew::identify
