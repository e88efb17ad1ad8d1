#include "components/robot/residual/run_length.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace sinew::residual {
namespace {

double NormalDensity(double x) {
  return std::exp(-0.5 * x * x) / std::sqrt(2.0 * std::numbers::pi);
}
double NormalShare(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

double Overshoot(double x) {
  if (x < 1e-6) return 1.0;
  const double half = 0.5 * x;
  return (2.0 / x) * (NormalShare(half) - 0.5) / (half * NormalShare(half) + NormalDensity(half));
}

}  // namespace

double MeanRunLength(double threshold, int window) {
  if (!(threshold >= 1.0) || window < 1) {
    throw std::invalid_argument("threshold " + std::to_string(threshold) + ", window " +
                                std::to_string(window) + ", expected at least 1");
  }
  const double lower = threshold / std::sqrt(static_cast<double>(window));
  constexpr int kSteps = 2000;  // Simpson
  const double step = (threshold - lower) / kSteps;
  double sum = 0.0;
  for (int i = 0; i <= kSteps; ++i) {
    const double x = lower + i * step;
    const double nu = Overshoot(x);
    const double weight = i == 0 || i == kSteps ? 1.0 : i % 2 == 1 ? 4.0 : 2.0;
    sum += weight * x * nu * nu;
  }
  // A window of one: every value is tested by itself.
  const double rate = threshold * NormalDensity(threshold) * sum * step / 3.0;
  const double alone = std::erfc(threshold / std::numbers::sqrt2);
  return 1.0 / std::max(rate, alone);
}

double ThresholdFor(double run_length, int window, int statistics) {
  if (!(run_length >= 10.0) || !std::isfinite(run_length) || statistics < 1) {
    throw std::invalid_argument("run length of " + std::to_string(run_length) + " blocks for " +
                                std::to_string(statistics) +
                                " statistics, expected at least 10 for at least 1");
  }
  double low = 1.0, high = 40.0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (MeanRunLength(middle, window) < run_length * statistics ? low : high) = middle;
  }
  return high;
}

}  // namespace sinew::residual
