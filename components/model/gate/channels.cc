#include "components/model/gate/channels.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "components/base/types/text.h"
#include "components/model/identify/processing.h"
#include "components/model/identify/statistics.h"

namespace sinew::gate {

using identify::Resolution;
using types::Run;
using types::Signal;

double QuantileOf(std::vector<double> values, double p) {
  return values.empty() ? 0.0 : identify::Quantile(std::move(values), p);
}

double Median(std::vector<double> values) { return QuantileOf(std::move(values), 0.5); }

double Range(const Eigen::VectorXd& x) { return x.size() > 0 ? x.maxCoeff() - x.minCoeff() : 0.0; }

double StandardDeviationOf(const Eigen::VectorXd& x) {
  return x.size() > 1 ? std::sqrt((x.array() - x.mean()).square().mean()) : 0.0;
}

double MedianPeriod(const Run& run) {
  std::vector<double> steps;
  for (Eigen::Index i = 1; i < run.size(); ++i) steps.push_back(run.time_s[i] - run.time_s[i - 1]);
  return Median(std::move(steps));
}

double SmallestStep(const Eigen::VectorXd& x) {
  const double step = Resolution(x);
  return step > 0.0 ? step : identify::WhiteNoise(std::span<const Eigen::VectorXd>(&x, 1));
}

double StepsIn(const Eigen::VectorXd& x) {
  const double step = SmallestStep(x);
  return step > 0.0 ? Range(x) / step : 0.0;
}

std::vector<Span> EqualSpans(const Eigen::VectorXd& x, Eigen::Index rows) {
  std::vector<Span> out;
  for (Eigen::Index first = 0; first < x.size();) {
    Eigen::Index last = first;
    while (last + 1 < x.size() && x[last + 1] == x[first]) ++last;
    if (last - first + 1 >= rows) out.push_back({first, last});
    first = last + 1;
  }
  return out;
}

std::map<Signal, Local> LocalCubics(const Run& run, const std::vector<Signal>& signals,
                                    double half_width_s, const std::vector<double>& at) {
  std::map<Signal, Local> out;
  const auto n = static_cast<Eigen::Index>(at.size());
  std::vector<std::pair<const Eigen::VectorXd*, Local*>> channels;
  for (const Signal signal : signals) {
    Local& local = out[signal];
    local.value = local.rate = local.acceleration = Eigen::VectorXd::Zero(n);
    channels.emplace_back(&run.At(signal), &local);
  }
  Eigen::Index from = 0;
  for (Eigen::Index k = 0; k < n; ++k) {
    const double centre = at[static_cast<std::size_t>(k)];
    while (from < run.size() && run.time_s[from] < centre - half_width_s) ++from;
    Eigen::Matrix4d gram = Eigen::Matrix4d::Zero();
    Eigen::MatrixXd right = Eigen::MatrixXd::Zero(4, static_cast<Eigen::Index>(channels.size()));
    for (Eigen::Index i = from; i < run.size(); ++i) {
      const double s = (run.time_s[i] - centre) / half_width_s;
      if (s > 1.0) break;
      const double tri = 1.0 - std::abs(s * s * s);
      const double weight = tri * tri * tri;
      const Eigen::Vector4d powers(1.0, s, s * s, s * s * s);
      gram.noalias() += weight * powers * powers.transpose();
      for (std::size_t c = 0; c < channels.size(); ++c) {
        right.col(static_cast<Eigen::Index>(c)) += weight * (*channels[c].first)[i] * powers;
      }
    }
    gram.diagonal().array() += 1e-12 * (gram(0, 0) + 1.0);
    const Eigen::MatrixXd fit = gram.ldlt().solve(right);
    for (std::size_t c = 0; c < channels.size(); ++c) {
      const auto column = static_cast<Eigen::Index>(c);
      channels[c].second->value[k] = fit(0, column);
      channels[c].second->rate[k] = fit(1, column) / half_width_s;
      channels[c].second->acceleration[k] = 2.0 * fit(2, column) / (half_width_s * half_width_s);
    }
  }
  return out;
}

std::vector<double> Centres(const Run& run, double half_width_s, std::size_t most) {
  std::vector<double> out;
  if (run.size() < 12) return out;
  const double first = run.time_s[0] + half_width_s;
  const double last = run.time_s[run.size() - 1] - half_width_s;
  const double step = std::max(
      0.5 * half_width_s, (last - first) / static_cast<double>(std::max<std::size_t>(most, 1)));
  const double rows = 2.0 * half_width_s / MedianPeriod(run);
  Eigen::Index from = 0, to = 0;
  for (double at = first; at <= last; at += step) {
    while (from < run.size() && run.time_s[from] < at - half_width_s) ++from;
    to = std::max(to, from);
    while (to < run.size() && run.time_s[to] <= at + half_width_s) ++to;
    if (static_cast<double>(to - from) > 0.7 * rows) out.push_back(at);
  }
  return out;
}

double HalfWidth_s(const Run& run, Signal signal) {
  const double period = MedianPeriod(run);
  const double duration = run.time_s[run.size() - 1] - run.time_s[0];
  const double coarse = std::max(5.0 * period, duration / 200.0);
  const std::vector<double> at = Centres(run, coarse, 1000);
  if (at.empty()) return coarse;
  const Local local = LocalCubics(run, {signal}, coarse, at).at(signal);
  const double speed = identify::Rms(local.rate);
  const double spread = StandardDeviationOf(run.At(signal));
  if (!(speed > 0.0)) return coarse;
  return std::clamp(0.25 * spread / speed, 5.0 * period, std::max(5.0 * period, duration / 50.0));
}

Measurement Measure(std::string_view rule, Signal signal, const Run& run, Span rows,
                    double statistic, std::string reason, std::string remedy) {
  return {.rule = std::string(rule),
          .signal = std::string(types::SignalName(signal)),
          .recording = run.name,
          .first_row = rows.first,
          .last_row = rows.last,
          .from_s = run.time_s[rows.first],
          .to_s = run.time_s[rows.last],
          .statistic = statistic,
          .reason = std::move(reason),
          .remedy = std::move(remedy)};
}

std::optional<Signal> OnlyDrive(const actuator::JointModel& model) {
  const auto drives =
      std::count_if(model.terms.begin(), model.terms.end(), [&model](const actuator::Term& term) {
        return model.Counts(term) && term.effect->info().role == effects::Role::kDrive;
      });
  return drives == 1 ? std::optional(identify::DriveSignal(model)) : std::nullopt;
}

Span WholeRun(const Run& run) { return {0, std::max<Eigen::Index>(run.size() - 1, 0)}; }

std::string Number(double value) { return types::Text("%.4g", value); }

}  // namespace sinew::gate
