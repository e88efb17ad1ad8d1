#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "components/base/types/joined.h"
#include "components/model/gate/checks.h"
#include "components/model/gate/rules.h"

namespace sinew::gate {

namespace {

using types::Run;
using types::Signal;

// Not the speeds: an impact turns them within a row, and they are not what is differentiated.
constexpr Signal kWatched[] = {Signal::kPosition,        Signal::kMotorPosition,
                               Signal::kMotorCurrent,    Signal::kTorque,
                               Signal::kChamberPressure, Signal::kReservoirPressure,
                               Signal::kLoadForce,       Signal::kTemperature};
constexpr Eigen::Index kSide = 4;  // rows on either side; near an end the same number in all

struct Distance {
  // Distance of the row from its neighbours' parabola, and at most from the two next to it.
  double own = 0.0;
  double neighbours = 0.0;  // the largest of theirs
};

Distance FromParabola(const Run& run, const Eigen::VectorXd& x, Eigen::Index row) {
  const Eigen::Index first = std::clamp<Eigen::Index>(row - kSide, 0, run.size() - 1 - 2 * kSide);
  const Eigen::Index last = first + 2 * kSide;
  const double level = x[row > 0 ? row - 1 : 1];
  Eigen::Matrix3d gram = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  const double scale = run.time_s[last] - run.time_s[first];
  const auto powers = [&](Eigen::Index i) {
    const double s = (run.time_s[i] - run.time_s[row]) / scale;
    return Eigen::Vector3d(1.0, s, s * s);
  };
  for (Eigen::Index i = first; i <= last; ++i) {
    if (i == row) continue;
    const Eigen::Vector3d p = powers(i);
    gram.noalias() += p * p.transpose();
    right += (x[i] - level) * p;
  }
  const Eigen::Vector3d fit = gram.inverse() * right;
  Distance out;
  for (Eigen::Index i = first; i <= last; ++i) {
    const double distance = std::abs(x[i] - level - fit.dot(powers(i)));
    if (i == row) {
      // A wrong stamp moves a row along its curve: it stays between its neighbours. The first and
      // the last row have one only, where a step is no spike: a spike lies beyond all other rows.
      const bool inside = row > 0 && row + 1 < x.size();
      const auto others = inside ? x.segment(row - 1, 3) : x.segment(1, x.size() - 2);
      const double low = inside ? std::min(x[row - 1], x[row + 1]) : others.minCoeff();
      const double high = inside ? std::max(x[row - 1], x[row + 1]) : others.maxCoeff();
      out.own = std::min(distance, std::max({0.0, low - x[row], x[row] - high}));
    } else {
      out.neighbours = std::max(out.neighbours, distance);
    }
  }
  return out;
}

// The step of a converter also where the channel rests: the low end of all changes, their middle
// where most rows repeat the one before.
double SmallSteps(const Eigen::VectorXd& x) {
  std::vector<double> steps = ChangesWhere(x, [](Eigen::Index) { return true; });
  const bool rests = 2 * static_cast<Eigen::Index>(steps.size()) < x.size();
  return QuantileOf(std::move(steps), rests ? 0.5 : 0.05);
}

// The statistic of the rule at every row.
std::vector<double> StatisticsOf(const Run& run, const Eigen::VectorXd& x) {
  std::vector<Distance> all;
  std::vector<double> own;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    all.push_back(FromParabola(run, x, i));
    own.push_back(all.back().own);
  }
  const double usual = std::max({QuantileOf(std::move(own), 0.99), SmallestStep(x), SmallSteps(x)});
  std::vector<double> out;
  out.reserve(all.size());
  for (const Distance& at : all) {
    const double scale = std::max(usual, at.neighbours);
    out.push_back(scale > 0.0 ? at.own / scale : 0.0);
  }
  return out;
}

// Change of the angle's slope from the rows before a row to those after it, as a displacement over
// these rows; 0 where the recording ends. `slope`: the larger of the two, in the same unit.
struct Kink {
  double change = 0.0, slope = 0.0;
};

Kink KinkAt(const Run& run, const Eigen::VectorXd& angle, Eigen::Index row) {
  if (row < kSide || row + kSide >= run.size()) return {};
  const double span_s = run.time_s[row - 1] - run.time_s[row - kSide];
  const double before = angle[row - 1] - angle[row - kSide];
  const double after = (angle[row + kSide] - angle[row + 1]) * span_s /
                       (run.time_s[row + kSide] - run.time_s[row + 1]);
  return {std::abs(after - before), std::max(std::abs(before), std::abs(after))};
}

// Usual changes in each channel of a recording.
struct Usual {
  std::map<Signal, double> change;  // 99 % quantile from row to row, at least a step
  std::map<Signal, double> step;
};

Usual UsualOf(const Run& run) {
  Usual out;
  for (const auto& [signal, x] : run.signals) {
    std::vector<double> changes;
    for (Eigen::Index i = 1; i < x.size(); ++i) changes.push_back(std::abs(x[i] - x[i - 1]));
    out.step[signal] = SmallestStep(x);
    out.change[signal] = std::max(QuantileOf(std::move(changes), 0.99), out.step[signal]);
  }
  return out;
}

// Does the motion answer: does the angle's slope change by more than half in this very row? Four
// values of white noise differ so by twice its deviation: six are three standard deviations. Beside
// the row the slope must not change as much: a smooth reversal is no answer.
bool MotionAnswers(const Run& run, Signal angle, Eigen::Index row, const Usual& usual) {
  constexpr double kHalfOfSlope = 0.5, kNoise = 6.0, kInThisRow = 2.0;
  if (!run.Has(angle)) return false;
  const Eigen::VectorXd& x = run.At(angle);
  const Kink at = KinkAt(run, x, row);
  const double beside =
      std::max(KinkAt(run, x, row - kSide - 1).change, KinkAt(run, x, row + kSide + 1).change);
  return at.change > kHalfOfSlope * at.slope && at.change > kInThisRow * beside &&
         at.change > kNoise * usual.step.at(angle);
}

bool IsAngle(Signal signal) {
  return signal == Signal::kPosition || signal == Signal::kMotorPosition;
}

// Does the channel jump into this row or out of it? The largest change of a sine is its 99 %
// quantile, that of 10^5 rows of white noise 1.7 times it. A jump of an angle has to stay.
bool JumpsInRow(Signal signal, const Eigen::VectorXd& x, Eigen::Index row, double usual_change) {
  constexpr double kAboveUsual = 3.0;
  const Eigen::Index before = std::max<Eigen::Index>(0, row - 1);
  const Eigen::Index after = std::min(x.size() - 1, row + 1);
  const double jump = IsAngle(signal)
                          ? std::abs(x[after] - x[before])
                          : std::max(std::abs(x[row] - x[before]), std::abs(x[after] - x[row]));
  return jump > kAboveUsual * usual_change;
}

// Cause that makes a row that stands alone an event of the machine; empty: none. An angle does not
// jump away and back within a row, whatever else happens.
std::string CauseOf(const Run& run, Signal signal, Eigen::Index row, const Usual& usual) {
  if (IsAngle(signal)) return "";
  for (const Signal angle : {Signal::kPosition, Signal::kMotorPosition}) {
    if (MotionAnswers(run, angle, row, usual)) {
      return "the slope of " + std::string(types::SignalName(angle)) + " changes";
    }
  }
  for (const auto& [other, x] : run.signals) {
    if (other != signal && JumpsInRow(other, x, row, usual.change.at(other))) {
      return std::string(types::SignalName(other)) + " jumps";
    }
  }
  return "";
}

// "row 812", "rows 3, 812 and 900", "rows 3, 4, 5, 6, 7 and 20 more".
std::string RowsText(const std::vector<Eigen::Index>& rows) {
  std::vector<std::string> words;
  for (const Eigen::Index row : rows) {
    if (words.size() == kMostLeftOut) break;
    words.push_back(std::to_string(row));
  }
  std::string last;
  if (rows.size() > words.size()) {
    last = std::to_string(rows.size() - words.size()) + " more";
  } else if (words.size() > 1) {
    last = words.back();
    words.pop_back();
  }
  return (rows.size() > 1 ? "rows " : "row ") + types::Joined(words) +
         (last.empty() ? "" : " and " + last);
}

std::string Where(const Run& run, Signal signal, const std::vector<Eigen::Index>& rows) {
  return RowsText(rows) + " of " + std::string(types::SignalName(signal)) + " in " + run.name;
}

Measurement MeasureRow(const Run& run, Signal signal, Eigen::Index row, double statistic,
                       std::size_t count) {
  const Eigen::VectorXd& x = run.At(signal);
  const bool first = row == 0, last = row + 1 == x.size();
  return Measure("spike", signal, run, {row, row}, statistic,
                 "the value " + Number(x[row]) + " " +
                     std::string(types::SignalUnit(signal, run.kind)) + " stands alone " +
                     (first  ? "before " + Number(x[row + 1])
                      : last ? "after " + Number(x[row - 1])
                             : "between " + Number(x[row - 1]) + " and " + Number(x[row + 1])) +
                     (count > 1 ? ", and " + std::to_string(count - 1) + " more like it." : "."),
                 "Leave the rows out of the file (a missing row is no fault).");
}

// One channel of a recording.
void CheckChannel(const Run& run, Signal signal, bool leave_out, SpikeCheck* out) {
  const Eigen::VectorXd& x = run.At(signal);
  const std::vector<double> statistics = StatisticsOf(run, x);
  const auto at = [&](Eigen::Index row) { return statistics[static_cast<std::size_t>(row)]; };
  const double limit = FindRule("spike").limit;
  std::optional<Usual> usual;  // few channels ask for it
  std::vector<Eigen::Index> alone, caused;
  std::string cause;             // of the first that has one
  Eigen::Index below_limit = 0;  // row with the largest of these statistics
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    if (!(at(i) > limit)) {
      if (!(at(below_limit) <= limit) || at(i) > at(below_limit)) below_limit = i;
      continue;
    }
    if (!usual) usual = UsualOf(run);
    const std::string why = CauseOf(run, signal, i, *usual);
    if (cause.empty()) cause = why;
    (why.empty() ? alone : caused).push_back(i);
  }
  const auto add_finding = [&](const char* name, const std::vector<Eigen::Index>& rows,
                               const std::string& text) {
    out->findings.push_back(
        {name, Where(run, signal, rows) + text, static_cast<double>(rows.size()), "rows"});
  };
  if (!caused.empty()) {
    add_finding("jumps", caused,
                (caused.size() > 1 ? " jump away and back, but " : " jumps away and back, but ") +
                    cause + " in the same row: kept");
  }
  if (!alone.empty() && (!leave_out || alone.size() > kMostLeftOut)) {
    const Eigen::Index largest = *std::max_element(
        alone.begin(), alone.end(), [&](Eigen::Index a, Eigen::Index b) { return at(a) < at(b); });
    out->measured.push_back(MeasureRow(run, signal, largest, at(largest), alone.size()));
    return;
  }
  out->measured.push_back(MeasureRow(run, signal, below_limit, at(below_limit), 1));
  if (alone.empty()) return;
  add_finding(kLeftOutRows, alone,
              alone.size() > 1 ? " stand alone: left out" : " stands alone: left out");
  out->left_out.push_back(
      {.run = 0, .signal = std::string(types::SignalName(signal)), .rows = std::move(alone)});
}

}  // namespace

SpikeCheck CheckSpikes(const Run& run, bool leave_out) {
  SpikeCheck out;
  if (run.held || run.size() < 100) return out;
  for (const Signal signal : kWatched) {
    if (!run.Has(signal) || !(Range(run.At(signal)) > 0.0)) continue;
    CheckChannel(run, signal, leave_out, &out);
  }
  return out;
}

}  // namespace sinew::gate
