// Of comparison.h: statistics over the seeds, and the time of a prediction.
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "components/model/identify/statistics.h"
#include "reproduction/network_tables/comparison.h"
#include "reproduction/networks/stepper.h"

namespace sinew::reproduction {

double Runs::Mean(const std::vector<double>& values) const { return identify::Mean(values); }
double Runs::Deviation(const std::vector<double>& values) const {
  return identify::StandardDeviation(values);
}

PairedOrder ComparePaired(const std::vector<double>& better, const std::vector<double>& worse) {
  if (better.size() != worse.size() || better.size() < 2) {
    throw std::invalid_argument("paired comparison: " + std::to_string(better.size()) + " and " +
                                std::to_string(worse.size()) +
                                " values, expected equally many, at least 2");
  }
  std::vector<double> differences;
  for (std::size_t k = 0; k < better.size(); ++k) differences.push_back(worse[k] - better[k]);
  PairedOrder order;
  order.pairs = static_cast<int>(differences.size());
  order.mean = identify::Mean(differences);
  const double half = identify::StudentQuantile(0.975, order.pairs - 1) *
                      identify::StandardDeviation(differences) / std::sqrt(order.pairs);
  order.low = order.mean - half;
  order.high = order.mean + half;
  order.verdict = order.low > 0.0    ? "as published"
                  : order.high < 0.0 ? "reversed"
                                     : "not distinguished";
  return order;
}

double StepTime_us(const networks::Model& model) {
  using Clock = std::chrono::steady_clock;
  networks::Stepper stepper(model);
  const Eigen::Index inputs = static_cast<Eigen::Index>(model.inputs.size());
  Eigen::MatrixXd u(inputs, 64);
  for (Eigen::Index t = 0; t < 64; ++t) {
    for (Eigen::Index m = 0; m < inputs; ++m) {
      u(m, t) = model.input.offset(m) +
                model.input.scale(m) * std::sin(0.1 * static_cast<double>(t * (m + 1)));
    }
  }
  constexpr int kRepeats = 9, kSteps = 512;
  std::vector<double> times;
  double sum = 0.0;
  for (int r = 0; r < kRepeats; ++r) {
    const Clock::time_point start = Clock::now();
    for (int t = 0; t < kSteps; ++t) sum += stepper.Step(u.col(t & 63));
    times.push_back(std::chrono::duration<double, std::micro>(Clock::now() - start).count() /
                    kSteps);
  }
  // Reads the sum, so that the loop is not optimised away.
  return std::isnan(sum) ? sum : identify::Quantile(times, 0.5);
}

}  // namespace sinew::reproduction
