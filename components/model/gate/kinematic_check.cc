#include <algorithm>
#include <cmath>
#include <numbers>

#include "components/model/gate/checks.h"
#include "components/model/identify/statistics.h"

namespace sinew::gate {

namespace {

using identify::Resolution;
using types::Run;
using types::Signal;

struct Agreement {
  double ratio = 1.0;        // of the rms, measured over derived
  double correlation = 0.0;  // of both
  std::size_t instants = 0;
};

// Over instants at which either moves.
Agreement Compare(const Eigen::VectorXd& measured, const Eigen::VectorXd& derived) {
  Agreement out;
  if (measured.size() < 20) return out;
  const double a = identify::Rms(measured), b = identify::Rms(derived);
  if (!(a > 0.0) || !(b > 0.0)) return out;
  out.ratio = a / b;
  out.correlation = measured.dot(derived) / (a * b * static_cast<double>(measured.size()));
  out.instants = static_cast<std::size_t>(measured.size());
  return out;
}

struct UnitFactor {
  double factor;
  const char* words;
};
constexpr UnitFactor kFactors[] = {
    {180.0 / std::numbers::pi, "degrees where radians are declared"},
    {30.0 / std::numbers::pi, "turns per minute where radians per second are declared"},
    {std::numbers::pi / 30.0, "radians where turns per minute are declared"},
    {0.5 / std::numbers::pi, "turns where radians are declared"},
    {2.0 * std::numbers::pi, "radians where turns are declared"},
    {std::numbers::pi / 180.0, "radians where degrees are declared"},
    {1e3, "thousandths (mm, mrad) where whole units are declared"},
    {1e-3, "whole units where thousandths are declared"},
    {100.0, "hundredths (cm) where whole units are declared"},
    {0.01, "whole units where hundredths are declared"},
};

std::string GuessUnit(double ratio) {
  for (const UnitFactor& at : kFactors) {
    if (std::abs(std::log(ratio / at.factor)) < 0.1) return std::string(", as of ") + at.words;
  }
  return "";
}

// A wrap stands out: noise of a joint at rest jumps by most of its range, but so does every row.
// One of 10^10 normal values is ten times as large as the median.
constexpr double kStandsOut = 10.0;

}  // namespace

std::vector<Measurement> CheckKinematics(const Run& run, const actuator::JointModel& model) {
  std::vector<Measurement> out;
  if (run.held || run.size() < 50) return out;
  const auto add = [&](const char* units, const char* sign, Signal signal, const Agreement& at,
                       const std::string& what, const std::string& remedy) {
    if (at.instants == 0) return;
    // The sizes of two that do not move together say nothing about units.
    const double together = std::abs(at.correlation);
    const double factor = together > 0.7 ? std::max(at.ratio, 1.0 / at.ratio) : 1.0;
    out.push_back(
        Measure(units, signal, run, WholeRun(run), factor,
                "it is " + Number(at.ratio) + " times " + what + GuessUnit(at.ratio) + ".",
                "Correct " + remedy + "."));
    out.push_back(
        Measure(sign, signal, run, WholeRun(run), -at.correlation,
                "it goes against " + what + " (correlation " + Number(at.correlation) + ").",
                "Correct the sign of one of the two in the mapping."));
  };
  const auto speed = [&](Signal angle, Signal measured) {
    if (!run.Has(angle) || !run.Has(measured)) return;
    if (!(Range(run.At(angle)) > 20.0 * SmallestStep(run.At(angle)))) return;
    const double half = HalfWidth_s(run, angle);
    const auto local = LocalCubics(run, {angle, measured}, half, Centres(run, half, 4000));
    add("units_speed", "sign_speed", measured,
        Compare(local.at(measured).value, local.at(angle).rate),
        "the derivative of " + std::string(types::SignalName(angle)),
        "the unit of one of the two in the mapping");
  };
  speed(Signal::kPosition, Signal::kVelocity);
  speed(Signal::kMotorPosition, Signal::kMotorVelocity);
  if (run.Has(Signal::kPosition) && run.Has(Signal::kMotorPosition)) {
    const double ratio = model.constants.gear_ratio > 0.0 ? model.constants.gear_ratio : 1.0;
    const Eigen::VectorXd& q = run.At(Signal::kPosition);
    const Eigen::VectorXd motor = run.At(Signal::kMotorPosition) / ratio;
    // Inside the free play, and where one shaft is locked, the two need not move together.
    const double play = 3.0 * model.backlash_rad;
    const double smaller = std::min(Range(q), Range(motor));
    const bool moves = Range(q) > play + 20.0 * SmallestStep(q) &&
                       smaller > 20.0 * std::min(SmallestStep(q), SmallestStep(motor));
    if (moves) {
      const double half = HalfWidth_s(run, Signal::kPosition);
      const auto local = LocalCubics(run, {Signal::kPosition, Signal::kMotorPosition}, half,
                                     Centres(run, half, 4000));
      add("units_gear", "sign_gear", Signal::kMotorPosition,
          Compare(local.at(Signal::kMotorPosition).rate / ratio, local.at(Signal::kPosition).rate),
          "the gear ratio of " + Number(ratio) + " and the output let expect",
          "`gear_ratio` of the model, or the unit of one of the two angles in the mapping");
    }
  }
  return out;
}

std::vector<Measurement> CheckWrapped(const Run& run) {
  std::vector<Measurement> out;
  if (run.held) return out;
  for (const Signal signal : {Signal::kPosition, Signal::kMotorPosition}) {
    if (!run.Has(signal) || run.size() < 12) continue;
    const Eigen::VectorXd& x = run.At(signal);
    const double range = Range(x);
    const double resolution = Resolution(x);
    if (!(range > 20.0 * std::max(resolution, 1e-12))) continue;
    const double period = MedianPeriod(run);
    const Eigen::Index n = x.size() - 1;
    Eigen::VectorXd jump = Eigen::VectorXd::Zero(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      std::vector<double> rates;
      for (Eigen::Index k = std::max<Eigen::Index>(0, i - 3); k <= std::min(n - 1, i + 3); ++k) {
        if (k != i) rates.push_back((x[k + 1] - x[k]) / (run.time_s[k + 1] - run.time_s[k]));
      }
      const double step_s = run.time_s[i + 1] - run.time_s[i];
      if (step_s < 3.0 * period) jump[i] = x[i + 1] - x[i] - Median(rates) * step_s;
    }
    const Eigen::VectorXd sizes = jump.cwiseAbs();
    const double usual =
        std::max(QuantileOf(std::vector<double>(sizes.data(), sizes.data() + n), 0.99), resolution);
    const double ordinary = Median(std::vector<double>(sizes.data(), sizes.data() + n));
    double most = 0.0;
    Eigen::Index where = 0;
    // One row before or after a jump does not show that it stays: that is a spike's.
    for (Eigen::Index i = 1; i + 1 < n; ++i) {
      if (!(sizes[i] > kStandsOut * ordinary)) continue;
      // A spike comes back in the next row.
      const double back =
          std::min(std::abs(jump[i] + jump[i - 1]), std::abs(jump[i] + jump[i + 1]));
      if (back < 0.5 * sizes[i]) continue;
      // A frozen channel catches up at the end of its equal rows.
      double statistic =
          i >= 5 && (x.segment(i - 5, 6).array() == x[i]).all() ? 0.0 : sizes[i] / range;
      const double turns = sizes[i] / (2.0 * std::numbers::pi);
      if (run.kind == types::JointKind::kRevolute && turns > 0.9 && sizes[i] > 20.0 * usual &&
          std::abs(turns - std::round(turns)) < 0.02) {
        statistic = std::max(statistic, 1.0);
      }
      if (statistic > most) {
        most = statistic;
        where = i;
      }
    }
    out.push_back(Measure(
        "wrapped", signal, run, {where, where + 1}, most,
        "it jumps by " + Number(jump[where]) + " " +
            std::string(types::SignalUnit(signal, run.kind)) + " between two rows and stays.",
        "Unwrap the angle before it is written, or map a channel that counts turns."));
  }
  return out;
}

}  // namespace sinew::gate
