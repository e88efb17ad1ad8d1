#include <algorithm>
#include <cmath>

#include "components/model/gate/checks.h"
#include "components/model/identify/statistics.h"

namespace sinew::gate {

namespace {

using identify::Resolution;
using types::Run;
using types::Signal;

constexpr Signal kMotion[] = {Signal::kPosition, Signal::kMotorPosition, Signal::kVelocity,
                              Signal::kMotorVelocity};
constexpr Signal kDrives[] = {Signal::kMotorCurrent, Signal::kDriveVoltage, Signal::kTorque};

bool Changes(const Eigen::VectorXd& x) { return (x.array() != x[0]).any(); }

double StepsMoved(const Run& run, Signal but) {
  double most = 0.0;
  for (const Signal signal : kMotion) {
    if (signal == but || !run.Has(signal)) continue;
    const Eigen::VectorXd& x = run.At(signal);
    if (x.allFinite()) most = std::max(most, StepsIn(x));
  }
  return most;
}

struct BadRows {
  Eigen::Index count = 0;
  Span span{0, -1};  // from the first to the last
};

template <class Bad>
BadRows FindBadRows(const Run& run, const Bad& bad) {
  BadRows out;
  for (Eigen::Index row = 0; row < run.size(); ++row) {
    if (!bad(row)) continue;
    if (out.count++ == 0) out.span.first = row;
    out.span.last = row;
  }
  return out;
}

void CheckFinite(const Run& run, std::vector<Measurement>* out) {
  for (const auto& [signal, x] : run.signals) {
    const BadRows bad =
        FindBadRows(run, [&values = x](Eigen::Index row) { return !std::isfinite(values[row]); });
    if (bad.count == 0) continue;
    out->push_back(Measure("non_finite", signal, run, bad.span, static_cast<double>(bad.count),
                           std::to_string(bad.count) + " values are no numbers.",
                           "Leave these rows out of the file."));
  }
}

void CheckStamps(const Run& run, std::vector<Measurement>* out) {
  const BadRows bad = FindBadRows(run, [&run](Eigen::Index row) {
    return row > 0 ? !(run.time_s[row] > run.time_s[row - 1]) : !std::isfinite(run.time_s[0]);
  });
  if (bad.count == 0) return;
  out->push_back(Measure("stamps", Signal::kPosition, run, bad.span, static_cast<double>(bad.count),
                         std::to_string(bad.count) + " rows are stamped no later than the row "
                                                     "before.",
                         "Sort the rows, or cut the file where its clock was set back."));
  out->back().signal.clear();
}

void CheckConstantChannels(const std::vector<Run>& runs, std::vector<Measurement>* out) {
  for (const Run& run : runs) {
    if (run.held) continue;
    for (const Signal signal : kMotion) {
      if (!run.Has(signal) || Changes(run.At(signal))) continue;
      // A motor that is locked stands still while its link is moved within the play: only a channel
      // of its own shaft shows that it turns.
      const bool motor = signal == Signal::kMotorPosition || signal == Signal::kMotorVelocity;
      const Signal twin = signal == Signal::kPosition        ? Signal::kVelocity
                          : signal == Signal::kVelocity      ? Signal::kPosition
                          : signal == Signal::kMotorPosition ? Signal::kMotorVelocity
                                                             : Signal::kMotorPosition;
      double steps = 0.0;
      if (motor) {
        if (run.Has(twin) && run.At(twin).allFinite()) steps = StepsIn(run.At(twin));
      } else {
        steps = StepsMoved(run, signal);
      }
      out->push_back(Measure(
          "constant", signal, run, WholeRun(run), steps, "it has one value while the joint moves.",
          "Take the channel out of the mapping, or map the column that holds it."));
    }
  }
  for (const Signal signal : kDrives) {
    double steps = 0.0;
    bool some = false, changes = false;
    for (const Run& run : runs) {
      if (!run.Has(signal) || run.held) continue;
      some = true;
      changes = changes || Changes(run.At(signal));
      steps = std::max(steps, StepsMoved(run, signal));
    }
    if (!some || changes) continue;
    out->push_back(Measure("constant", signal, runs.front(), WholeRun(runs.front()), steps,
                           "the drive has one value in all recordings while the joint moves.",
                           "Map the column that holds the drive."));
    out->back().recording.clear();
  }
}

void CheckDuplicates(const Run& run, const actuator::JointModel& model,
                     std::vector<Measurement>* out) {
  const auto shaft = [](Signal a, Signal b) {
    return (a == Signal::kPosition && b == Signal::kMotorPosition) ||
           (a == Signal::kVelocity && b == Signal::kMotorVelocity);
  };
  for (auto a = run.signals.begin(); a != run.signals.end(); ++a) {
    for (auto b = std::next(a); b != run.signals.end(); ++b) {
      if (shaft(a->first, b->first) && model.constants.gear_ratio == 1.0) continue;
      const Eigen::VectorXd &x = a->second, &y = b->second;
      if (!Changes(x) || !Changes(y)) continue;
      const double share = static_cast<double>((x.array() == y.array()).count()) /
                           static_cast<double>(std::max<Eigen::Index>(x.size(), 1));
      // Two switches agree by chance; two sensors do not.
      out->push_back(
          Measure("duplicated", b->first, run, WholeRun(run), StepsIn(x) > 20.0 ? share : 0.0,
                  "it is the same column as " + std::string(types::SignalName(a->first)) + ".",
                  "Map each signal to its own column."));
    }
  }
}

// Speeds are compared with their angles (units_speed).
constexpr Signal kCompared[] = {
    Signal::kPosition,          Signal::kMotorPosition, Signal::kMotorCurrent,
    Signal::kDriveVoltage,      Signal::kTorque,        Signal::kChamberPressure,
    Signal::kReservoirPressure, Signal::kLoadForce,     Signal::kTemperature};

struct Scale {
  std::size_t run = 0;
  double step = 0.0, range = 0.0;
};

// Between units of one kind: degrees, turns, thousandths, hundredths, psi, kgf, pound.
bool IsUnitFactor(double ratio) {
  const double factor = ratio > 1.0 ? ratio : 1.0 / ratio;
  for (const double unit :
       {57.29578, 6.283185, 360.0, 1e3, 100.0, 1e5, 14.50377, 6.894757, 9.80665, 4.448222}) {
    if (std::abs(factor / unit - 1.0) < 0.02) return true;
  }
  return false;
}

}  // namespace

std::vector<Measurement> CheckStructure(const std::vector<Run>& runs,
                                        const actuator::JointModel& model) {
  std::vector<Measurement> out;
  std::vector<Run> finite;
  for (const Run& run : runs) {
    if (run.size() == 0) continue;
    const std::size_t before = out.size();
    CheckStamps(run, &out);
    CheckFinite(run, &out);
    if (out.size() == before) finite.push_back(run);
  }
  CheckConstantChannels(finite, &out);
  for (const Run& run : finite) CheckDuplicates(run, model, &out);
  return out;
}

std::vector<Measurement> CheckRecordings(const std::vector<Run>& runs) {
  std::vector<Measurement> out;
  for (const Signal signal : kCompared) {
    std::vector<Scale> scales;
    for (std::size_t k = 0; k < runs.size(); ++k) {
      if (!runs[k].Has(signal) || runs[k].held) continue;
      const Eigen::VectorXd& x = runs[k].At(signal);
      const double step = Changes(x) ? Resolution(x) : 0.0;
      if (step > 0.0) scales.push_back({k, step, Range(x)});
    }
    for (const Scale& one : scales) {
      std::vector<double> steps, ranges;
      for (const Scale& other : scales) {
        if (other.run == one.run) continue;
        steps.push_back(other.step);
        ranges.push_back(other.range);
      }
      if (steps.empty()) continue;
      const double factor = one.step / Median(steps);
      const double by_range = one.range / Median(ranges);
      // Steps of a converter stand in the ratio of the units to the last digit; noise does not.
      const double both =
          factor > 1.0 ? std::min(factor, by_range) : std::min(1.0 / factor, 1.0 / by_range);
      const Run& run = runs[one.run];
      out.push_back(
          Measure("recording_differs", signal, run, WholeRun(run),
                  IsUnitFactor(factor) ? std::max(both, 1.0) : 1.0,
                  "its steps are " + Number(factor) + " times as large as in the other recordings.",
                  "Give this file a mapping of its own, with the unit of its column."));
    }
  }
  return out;
}

}  // namespace sinew::gate
