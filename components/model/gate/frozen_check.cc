#include <algorithm>
#include <cmath>
#include <optional>

#include "components/model/gate/checks.h"
#include "components/model/identify/statistics.h"

namespace sinew::gate {

namespace {

using identify::Resolution;
using types::Run;
using types::Signal;

constexpr Eigen::Index kLeastRows = 6;
constexpr int kWindows = 400;

Eigen::VectorXd Integral(const Run& run, const Eigen::VectorXd& rate) {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(rate.size());
  for (Eigen::Index i = 1; i < rate.size(); ++i) {
    out[i] = out[i - 1] + 0.5 * (rate[i] + rate[i - 1]) * (run.time_s[i] - run.time_s[i - 1]);
  }
  return out;
}

double RangeOver(const Eigen::VectorXd& x, Span rows) {
  const auto part = x.segment(rows.first, rows.rows());
  return part.maxCoeff() - part.minCoeff();
}

Measurement Said(Measurement worst, const std::string& what) {
  worst.reason = "it is equal to the bit over " +
                 std::to_string(worst.last_row - worst.first_row + 1) + " rows " + what;
  worst.remedy = "Cut these rows out of the file.";
  return worst;
}

// `suspect` is equal to the bit over spans; a and b measure the same displacement, one of them by
// the suspect.
Measurement ComparePair(const Run& run, Signal suspect, const Eigen::VectorXd& a,
                        const Eigen::VectorXd& b, double fixed_allowance, double allowance_per_s,
                        const std::string& other) {
  const Eigen::VectorXd difference = a - b;
  const std::vector<Span> spans = EqualSpans(run.At(suspect), kLeastRows);
  std::vector<char> equal(static_cast<std::size_t>(run.size()), 0);
  for (const Span& span : spans) {
    for (Eigen::Index i = span.first; i <= span.last; ++i) equal[static_cast<std::size_t>(i)] = 1;
  }
  std::vector<Eigen::Index> before(1, 0);  // equal rows up to here
  for (const char at : equal) before.push_back(before.back() + at);
  Measurement worst = Measure("frozen", suspect, run, {0, 0}, 0.0);
  for (Span span : spans) {
    if (span.last + 1 < run.size()) ++span.last;  // where it lets go
    // A speed that rounds to other than zero at rest moves on paper.
    const double allowance =
        fixed_allowance + allowance_per_s * (run.time_s[span.last] - run.time_s[span.first]);
    const double apart = RangeOver(difference, {span.first, span.last - 1});
    if (!(apart > allowance)) continue;
    double elsewhere = 0.0;
    const Eigen::Index stride = std::max<Eigen::Index>(1, run.size() / kWindows);
    for (Eigen::Index first = 0; first + span.rows() <= run.size(); first += stride) {
      const Eigen::Index last = first + span.rows() - 1;
      const Eigen::Index frozen =
          before[static_cast<std::size_t>(last + 1)] - before[static_cast<std::size_t>(first)];
      // The end of a frozen span is a jump of the same size: windows away from all of them.
      if (frozen > 0) continue;
      elsewhere = std::max(elsewhere, RangeOver(difference, {first, last}));
    }
    const double statistic = apart / std::max(elsewhere, allowance);
    if (statistic <= worst.statistic) continue;
    worst = Measure("frozen", suspect, run, {span.first, span.last - 1}, statistic);
  }
  return Said(std::move(worst), "while " + other + " says that it must change.");
}

// Alone: an angle that holds still and then jumps to where it should be.
Measurement JumpAtEnd(const Run& run, Signal signal) {
  const Eigen::VectorXd& x = run.At(signal);
  const std::vector<Span> spans = EqualSpans(x, kLeastRows);
  const double period = MedianPeriod(run);
  std::vector<char> ends(static_cast<std::size_t>(x.size()), 0);
  for (const Span& span : spans) ends[static_cast<std::size_t>(span.last)] = 1;
  const auto within = [&](Eigen::Index row) { return ends[static_cast<std::size_t>(row)] == 0; };
  const double usual = QuantileOf(ChangesWhere(x, within), 0.999) + Resolution(x);
  Measurement worst = Measure("frozen", signal, run, {0, 0}, 0.0);
  for (const Span& span : spans) {
    if (span.last + 1 >= x.size() || !(usual > 0.0)) continue;
    if (run.time_s[span.last + 1] - run.time_s[span.last] > 1.5 * period) continue;
    const double statistic = std::abs(x[span.last + 1] - x[span.last]) / usual;
    if (statistic > worst.statistic) worst = Measure("frozen", signal, run, span, statistic);
  }
  return Said(std::move(worst), "and then jumps further than it ever moves within a row.");
}

// Does the channel step by single counts? Then a level that stays is one that the noise does not
// carry over the edge of a count, and only a jump by more shows that the channel had stopped.
bool StepsByCounts(const Eigen::VectorXd& x) {
  const std::vector<double> steps = ChangesWhere(x, [](Eigen::Index) { return true; });
  return !steps.empty() && QuantileOf(steps, 0.9) < 1.5 * Resolution(x);
}

// Further than the channel ever moves within a row, at the start or the end of a span.
struct JumpsOf {
  bool at_start = false, at_end = false;
};

JumpsOf Jumps(const Eigen::VectorXd& x, const Span& span) {
  const auto beside = [&](Eigen::Index row) { return row + 1 != span.first && row != span.last; };
  const double furthest = QuantileOf(ChangesWhere(x, beside), 0.999) + 0.5 * Resolution(x);
  JumpsOf out;
  out.at_start = span.first > 0 && std::abs(x[span.first] - x[span.first - 1]) > furthest;
  out.at_end = span.last + 1 < x.size() && std::abs(x[span.last + 1] - x[span.last]) > furthest;
  return out;
}

// The span with the holds that follow it or come before it without another row between: a limit
// that moves in steps.
Span WithNextHolds(const Eigen::VectorXd& x, Span span) {
  const auto holds = [&](Eigen::Index first) {
    return first >= 0 && first + kLeastRows <= x.size() &&
           (x.segment(first, kLeastRows).array() == x[first]).all();
  };
  while (holds(span.first - kLeastRows)) span.first -= kLeastRows;
  while (holds(span.last + 1)) span.last += kLeastRows;
  return span;
}

// Saturation: a limit holds the drive where it is larger than in as many rows on either side as it
// is held, and it comes to the limit and leaves it by steps of its own. The limit may move, as with
// the voltage of a bus. A channel that froze jumps to where it should be.
bool IsAtALimit(const Eigen::VectorXd& x, const Span& hold) {
  const Span span = WithNextHolds(x, hold);
  const Eigen::Index beside = std::max(kLeastRows, span.rows());
  const Eigen::Index before = std::min(span.first, beside);
  const Eigen::Index after = std::min(x.size() - 1 - span.last, beside);
  const double at_first = std::abs(x[span.first]), at_last = std::abs(x[span.last]);
  if ((x.segment(span.first - before, before).array().abs() > at_first).any()) return false;
  if ((x.segment(span.last + 1, after).array().abs() > at_last).any()) return false;
  const JumpsOf jumps = Jumps(x, span);
  return !jumps.at_start && !jumps.at_end;
}

// Error that a span's length may have where stamps jitter about rows that were read evenly: as
// large as that of a period.
double StampScatter(const Run& run) {
  std::vector<double> off;
  const double period = MedianPeriod(run);
  for (Eigen::Index i = 1; i < run.size(); ++i) {
    off.push_back(std::abs(run.time_s[i] - run.time_s[i - 1] - period));
  }
  return QuantileOf(off, 0.99);
}

// A rate that an angle moved by all the time: where an encoder's counts come as evenly as the rows,
// a rate computed from them settles to the bit.
bool FollowsTheAngle(const Run& run, Signal angle, double rate, const Span& span,
                     double stamp_scatter_s) {
  constexpr double kRounding = 3.0;  // steps: one at each end, and the rate's own
  const Eigen::VectorXd& x = run.At(angle);
  const double moved = x[span.last] - x[span.first];
  const double duration_s = run.time_s[span.last] - run.time_s[span.first];
  return std::abs(moved - rate * duration_s) <=
         kRounding * SmallestStep(x) + std::abs(rate) * stamp_scatter_s;
}

// The angle whose rate a channel is.
std::optional<Signal> AngleOf(const Run& run, Signal rate) {
  if (rate == Signal::kVelocity && run.Has(Signal::kPosition)) return Signal::kPosition;
  if (rate == Signal::kMotorVelocity && run.Has(Signal::kMotorPosition)) {
    return Signal::kMotorPosition;
  }
  return std::nullopt;
}

// Channels whose noise changes them with every row, over rows in which the joint moves.
Measurement LongRun(const Run& run, Signal signal, Signal joint_angle,
                    const std::vector<char>& moving) {
  const Eigen::VectorXd& x = run.At(signal);
  Measurement worst = Measure("frozen", signal, run, {0, 0}, 0.0);
  const double range = Range(x);
  if (!(range > 0.0)) return worst;
  const double low = x.minCoeff() + 1e-3 * range, high = x.maxCoeff() - 1e-3 * range;
  std::vector<double> lengths;
  std::vector<Span> runs;
  double repeats = 0.0, rows = 0.0;
  for (const Span& span : EqualSpans(x, 1)) {
    const double value = x[span.first];
    Eigen::Index moved = 0;
    for (Eigen::Index i = span.first; i <= span.last; ++i) {
      moved += moving[static_cast<std::size_t>(i)];
    }
    // Switched off or at its limit: it has a reason to stay.
    if (moved == 0 || value == 0.0 || value <= low || value >= high) continue;
    lengths.push_back(static_cast<double>(moved));
    runs.push_back(span);
    repeats += span.rows() > 1 ? static_cast<double>(moved) - 1.0 : 0.0;
    rows += static_cast<double>(moved);
  }
  if (lengths.size() < 50) return worst;
  // A frozen span must not hide behind the repeats that it makes itself.
  std::vector<double> sorted = lengths;
  std::sort(sorted.begin(), sorted.end());
  const double longest = sorted.back();
  repeats -= longest;
  rows -= longest;
  const double share = std::clamp(repeats / std::max(rows, 1.0), 1.0 / std::max(rows, 2.0), 0.999);
  const double chance = 1.0 + std::log(static_cast<double>(lengths.size())) / std::log(1.0 / share);
  const double usual = std::max(chance, 3.0 * QuantileOf(sorted, 0.99));
  const bool counts = StepsByCounts(x);
  const bool drive = signal == Signal::kMotorCurrent || signal == Signal::kDriveVoltage ||
                     signal == Signal::kTorque;
  // The range of 10^5 rows of white noise is ten times its deviation; a resting encoder turns by a
  // step or two. What is computed from a resting joint may stay.
  constexpr double kFewSteps = 10.0;
  const double rest = kFewSteps * SmallestStep(run.At(joint_angle));
  const std::optional<Signal> angle = AngleOf(run, signal);
  const double scatter_s = angle ? StampScatter(run) : 0.0;
  // A drive that saturates does so time and again: once may as well be where a frozen one stood.
  const std::vector<Span> holds = EqualSpans(x, kLeastRows);
  const bool saturates = drive && std::count_if(holds.begin(), holds.end(), [&](const Span& span) {
                                    return IsAtALimit(x, span);
                                  }) > 1;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (lengths[i] < static_cast<double>(kLeastRows)) continue;
    if (counts && !Jumps(x, runs[i]).at_end) continue;
    if (!(RangeOver(run.At(joint_angle), runs[i]) > rest)) continue;
    if (saturates && IsAtALimit(x, runs[i])) continue;
    if (angle && FollowsTheAngle(run, *angle, x[runs[i].first], runs[i], scatter_s)) continue;
    const double statistic = lengths[i] / usual;
    if (statistic > worst.statistic) worst = Measure("frozen", signal, run, runs[i], statistic);
  }
  return Said(std::move(worst), "while the joint moves; chance makes " + Number(usual) + ".");
}

std::vector<char> MovingRows(const Run& run, Signal angle) {
  std::vector<char> out(static_cast<std::size_t>(run.size()), 0);
  const double half = HalfWidth_s(run, angle);
  const std::vector<double> at = Centres(run, half, 8000);
  if (at.empty()) return out;
  const Eigen::VectorXd rate = LocalCubics(run, {angle}, half, at).at(angle).rate;
  const double least = 0.2 * identify::Rms(rate);
  std::size_t k = 0;
  for (Eigen::Index i = 0; i < run.size(); ++i) {
    while (k + 1 < at.size() && at[k + 1] <= run.time_s[i]) ++k;
    out[static_cast<std::size_t>(i)] = std::abs(rate[static_cast<Eigen::Index>(k)]) > least;
  }
  return out;
}

}  // namespace

std::vector<Measurement> CheckFrozen(const Run& run, const actuator::JointModel& model) {
  std::vector<Measurement> out;
  if (run.held || run.size() < 100) return out;
  const double ratio = model.constants.gear_ratio > 0.0 ? model.constants.gear_ratio : 1.0;
  const auto has = [&](Signal signal) { return run.Has(signal) && Range(run.At(signal)) > 0.0; };
  const auto step = [&](Signal signal) { return SmallestStep(run.At(signal)); };
  const auto name = [](Signal signal) { return std::string(types::SignalName(signal)); };
  const auto by_rate = [&](Signal angle, Signal rate) {
    if (!has(angle) || !has(rate)) return;
    const Eigen::VectorXd moved = Integral(run, run.At(rate));
    const double allowance = 10.0 * step(angle);
    out.push_back(ComparePair(run, angle, run.At(angle), moved, allowance, step(rate), name(rate)));
    out.push_back(ComparePair(run, rate, moved, run.At(angle), allowance, step(rate), name(angle)));
  };
  by_rate(Signal::kPosition, Signal::kVelocity);
  by_rate(Signal::kMotorPosition, Signal::kMotorVelocity);
  if (has(Signal::kPosition) && has(Signal::kMotorPosition) && ratio != 1.0) {
    const Eigen::VectorXd output = run.At(Signal::kMotorPosition) / ratio;
    const double allowance = model.backlash_rad + 10.0 * (step(Signal::kPosition) +
                                                          step(Signal::kMotorPosition) / ratio);
    out.push_back(ComparePair(run, Signal::kPosition, run.At(Signal::kPosition), output, allowance,
                              0.0, name(Signal::kMotorPosition)));
    out.push_back(ComparePair(run, Signal::kMotorPosition, output, run.At(Signal::kPosition),
                              allowance, 0.0, name(Signal::kPosition)));
  }
  for (const Signal signal : {Signal::kPosition, Signal::kMotorPosition}) {
    if (has(signal)) out.push_back(JumpAtEnd(run, signal));
  }
  const Signal angle = has(Signal::kPosition) ? Signal::kPosition : Signal::kMotorPosition;
  if (!has(angle)) return out;
  const std::vector<char> moving = MovingRows(run, angle);
  for (const Signal signal :
       {Signal::kVelocity, Signal::kMotorVelocity, Signal::kMotorCurrent, Signal::kDriveVoltage,
        Signal::kTorque, Signal::kLoadForce, Signal::kChamberPressure}) {
    if (has(signal)) out.push_back(LongRun(run, signal, angle, moving));
  }
  return out;
}

}  // namespace sinew::gate
