#include "components/model/trace/sensitivity.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <string>

#include "components/base/types/text.h"
#include "components/model/identify/statistics.h"
#include "components/model/trace/null_test.h"
#include "components/model/trace/rules.h"

namespace sinew::trace {

namespace {

constexpr double kPower = 0.8;
// A real effect is not exactly its column: by so much larger it has to be. `rig_bank plant` on
// rigs 1300 to 1399 found 68 % at the size of the exact column, 85 % at 1.2 of it.
constexpr double kInexact = 1.15;

// Share of recordings in which the gain of k columns of that noncentrality reaches `needed`.
double ShareThatReaches(double needed, int columns, double noncentrality) {
  const double k = columns;
  const double deviations = (k + noncentrality - needed) / std::sqrt(2.0 * k + 4.0 * noncentrality);
  return 0.5 * std::erfc(-deviations / std::numbers::sqrt2);
}

// Apparent size of an effect in this recording, in standard errors, what noise adds taken off.
double ApparentSize(const Problem& problem, const Hypothesis& h, Eigen::Index column,
                    const EffectSet& found) {
  for (const std::size_t member : found.members) {
    if (problem.hypotheses()[member].name == h.name) return 0.0;  // it is the effect itself
  }
  Columns columns = found.columns;
  if (std::find(columns.begin(), columns.end(), column) != columns.end()) return 0.0;
  columns.push_back(column);
  const Eigen::Index last = static_cast<Eigen::Index>(columns.size()) - 1;
  const double coefficient = problem.evidence.Solve(columns)[last];
  const double variance = problem.evidence.Covariance(columns)(last, last);
  return std::sqrt(std::max(0.0, coefficient * coefficient / variance - 1.0));
}

// Lines are there when they are found.
bool HasSize(const Hypothesis& h) {
  return h.physical() && h.asked == Asked::kSearched && h.settings.size() == 1;
}

std::vector<std::pair<std::string, double>> ShapeOf(const Hypothesis& h, types::JointKind kind) {
  std::vector<std::pair<std::string, double>> out;
  const auto& infos = h.effect->info().nonlinear;
  const std::vector<double>& psi = h.settings.front().psi;
  for (std::size_t i = 0; i < infos.size() && i < psi.size(); ++i) {
    if (i == 0 && h.effect->info().event) continue;  // an instant is no shape
    out.emplace_back(effects::ParameterKey(infos[i], kind), psi[i]);
  }
  return out;
}

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr const char* kCarried =
    "the declared terms carry all of it: only a shift of parameters shows";

// Above 1: a size that matters, or that machines have, would not have been found.
double Hides(const DetectableSize& size, const InForce& in_force) {
  return std::max(size.share / in_force.Limit(rules::kDetectable), size.of_expected);
}

// Empty: it would have been found before it matters, and as large as machines have it.
std::string WhyHidden(const DetectableSize& size, const InForce& in_force) {
  if (size.share >= 1.0) return "up to all of the measured side could hide in this motion";
  if (size.share > in_force.Limit(rules::kDetectable)) {
    return types::Text("up to %.2g %% of the measured side could hide in this motion",
                       100.0 * size.share);
  }
  if (size.of_expected > 1.0) {
    return types::Text("found from %.2g %s on, %.2g times what machines have", size.size,
                       size.unit.c_str(), size.of_expected);
  }
  return "";
}

// Coefficient c that takes `share` of the variance away where least squares see it smaller by
// `other`: c (c - 2 other) = share / (1 - share) variance / power.
double VarianceSize(double share, double variance_per_power, double other) {
  if (!(share < 1.0)) return kNever;
  return other + std::sqrt(other * other + share / (1.0 - share) * variance_per_power);
}

}  // namespace

double NeededGain(const Hypothesis& hypothesis, double misfit, double occam, double statistic,
                  double by_variance, const InForce& in_force) {
  // The effect is part of the misfit that its share is taken of.
  const double share = in_force.Limit(RuleOfShare(hypothesis));
  const double by_share = (share * misfit + occam + hypothesis.charge) / (1.0 - share);
  return std::max(std::min(by_share, by_variance), GainOfStatistic(statistic, hypothesis));
}

double SizeForPower(double needed, int columns, double other) {
  const auto share = [&](double size) {
    const double less = size > other ? size - other : 0.0;
    return 0.5 * (ShareThatReaches(needed, columns, (size + other) * (size + other)) +
                  (less > 0.0 ? ShareThatReaches(needed, columns, less * less) : 0.0));
  };
  double low = other;
  double high = other + std::sqrt(std::max(0.0, needed)) + 5.0;
  constexpr int kHalvings = 50;  // more than a double's digits
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (share(middle) < kPower ? low : high) = middle;
  }
  return high;
}

std::optional<double> DetectableCoefficient(const Problem& problem, const Hypothesis& hypothesis,
                                            Eigen::Index j, double statistic, double by_variance,
                                            double other) {
  const Evidence& evidence = problem.evidence;
  const double reduced = evidence.reduced()(j, j);
  if (!(evidence.FreeShare(j) >= problem.in_force().Limit(rules::kAbsorbed)) || !(reduced > 0.0)) {
    return std::nullopt;
  }
  const double needed =
      NeededGain(hypothesis, evidence.misfit(), evidence.Occam(hypothesis.columns), statistic,
                 by_variance * by_variance * reduced, problem.in_force());
  return kInexact * SizeForPower(needed, static_cast<int>(hypothesis.columns.size()), other) /
         std::sqrt(reduced);
}

std::vector<DetectableSize> FindDetectable(const Problem& problem,
                                           const actuator::JointModel& declared, double statistic,
                                           const EffectSet& found) {
  const double target_rms =
      problem.measured_rms > 0.0 ? problem.measured_rms : identify::Rms(problem.bank.target);
  const double target_peak = problem.measured_peak > 0.0 ? problem.measured_peak
                             : problem.bank.target.size() > 0
                                 ? problem.bank.target.cwiseAbs().maxCoeff()
                                 : 0.0;
  const double drive_share = actuator::DriveShare(declared, declared.balance);
  std::map<std::pair<std::string, std::size_t>, DetectableSize> best;
  // The part of a column that the declared terms carry, not whitened.
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(problem.bank.declared);
  const Eigen::MatrixXd Q =
      qr.householderQ() *
      Eigen::MatrixXd::Identity(problem.bank.declared.rows(), problem.bank.declared.cols());
  const Eigen::VectorXd left =
      identify::LeftBy(problem.bank.declared, problem.bank.target - problem.Part(found));
  for (const Hypothesis& h : problem.hypotheses()) {
    if (!HasSize(h) || !(target_rms > 0.0)) continue;
    const auto& infos = h.effect->info().linear;
    for (std::size_t i = 0; i < h.columns.size() && i < infos.size(); ++i) {
      const Eigen::Index j = h.columns[i];
      const Eigen::VectorXd column = problem.bank.columns.col(j);
      const double power = column.squaredNorm() - (Q.transpose() * column).squaredNorm();
      const double by_variance =
          power > 0.0 ? VarianceSize(LeastVariance(h, problem.in_force()), problem.variance / power,
                                     std::abs(left.dot(column)) / power)
                      : kNever;
      const std::optional<double> found_from = DetectableCoefficient(
          problem, h, j, statistic, by_variance, ApparentSize(problem, h, j, found));
      if (!found_from) continue;
      const double c = *found_from;
      // Larger than any torque that was measured: the rows show no more than a trace of it.
      if (infos[i].dimension == effects::Dimension::kTorque && c > target_peak) continue;
      const DetectableSize size = {
          .effect = h.name,
          .balance = declared.balance,
          .parameter = effects::ParameterKey(infos[i], declared.kind),
          .unit = std::string(effects::UnitSuffix(infos[i].dimension, declared.kind)),
          .size = std::abs(problem.scale) * c / (infos[i].relative_to_drive ? drive_share : 1.0),
          .share = c * identify::Rms(column) / target_rms,
          .of_expected = c / problem.bank.spread[j],
          .shape = ShapeOf(h, declared.kind)};
      const auto [at, fresh] = best.try_emplace({h.name, i}, size);
      if (!fresh && Hides(size, problem.in_force()) < Hides(at->second, problem.in_force()))
        at->second = size;
    }
  }
  std::vector<DetectableSize> out;
  out.reserve(best.size());
  for (auto& [key, size] : best) out.push_back(std::move(size));
  return out;
}

void NoteSensitivity(const Problem& problem, TraceResult* result) {
  for (const Untestable& effect : problem.bank.untestable) {
    result->not_excited.push_back({effect.effect, effect.why});
  }
  // By effect the parameter with the smallest share; null: absorbed.
  std::map<std::string, const DetectableSize*> smallest;
  for (const Hypothesis& h : problem.hypotheses()) {
    if (HasSize(h)) smallest.try_emplace(h.name, nullptr);
  }
  for (const DetectableSize& size : result->detectable) {
    const DetectableSize*& least = smallest[size.effect];
    if (!least || Hides(size, problem.in_force()) < Hides(*least, problem.in_force()))
      least = &size;
  }
  std::set<std::string> shown;
  for (const auto* list : {&result->effects, &result->open}) {
    for (const FoundEffect& found : *list) shown.insert(found.name);
  }
  result->assessed.assign(shown.begin(), shown.end());
  for (const auto& [name, size] : smallest) {
    if (shown.contains(name)) continue;
    const std::string why = size ? WhyHidden(*size, problem.in_force()) : kCarried;
    if (why.empty()) {
      result->assessed.push_back(name);
    } else {
      result->not_excited.push_back({name, why});
    }
  }
  std::sort(result->not_excited.begin(), result->not_excited.end(),
            [](const NotExcited& a, const NotExcited& b) { return a.effect < b.effect; });
}

}  // namespace sinew::trace
