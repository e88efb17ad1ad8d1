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
    if (!x.allFinite()) continue;
    const double step = SmallestStep(x);
    if (step > 0.0) most = std::max(most, Range(x) / step);
  }
  return most;
}

void CheckFinite(const Run& run, std::vector<Measurement>* out) {
  for (const auto& [signal, x] : run.signals) {
    Eigen::Index bad = 0;
    Span rows{0, -1};
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      if (std::isfinite(x[i])) continue;
      if (bad++ == 0) rows.first = i;
      rows.last = i;
    }
    if (bad == 0) continue;
    Measurement at = Measure("non_finite", signal, run, rows, static_cast<double>(bad));
    at.reason = std::to_string(bad) + " values are no numbers.";
    at.remedy = "Leave these rows out of the file.";
    out->push_back(std::move(at));
  }
}

void CheckStamps(const Run& run, std::vector<Measurement>* out) {
  Eigen::Index bad = 0;
  Span rows{0, -1};
  for (Eigen::Index i = 0; i < run.size(); ++i) {
    if (i > 0 ? run.time_s[i] > run.time_s[i - 1] : std::isfinite(run.time_s[0])) continue;
    if (bad++ == 0) rows.first = i;
    rows.last = i;
  }
  if (bad == 0) return;
  Measurement at;
  at.rule = "stamps";
  at.recording = run.name;
  at.first_row = rows.first;
  at.last_row = rows.last;
  at.from_s = run.time_s[rows.first];
  at.to_s = run.time_s[rows.last];
  at.statistic = static_cast<double>(bad);
  at.reason = std::to_string(bad) + " rows are stamped no later than the row before.";
  at.remedy = "Sort the rows, or cut the file where its clock was set back.";
  out->push_back(std::move(at));
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
        if (run.Has(twin) && run.At(twin).allFinite()) {
          const double step = SmallestStep(run.At(twin));
          steps = step > 0.0 ? Range(run.At(twin)) / step : 0.0;
        }
      } else {
        steps = StepsMoved(run, signal);
      }
      Measurement at = Measure("constant", signal, run, WholeRun(run), steps);
      at.reason = "it has one value while the joint moves.";
      at.remedy = "Take the channel out of the mapping, or map the column that holds it.";
      out->push_back(std::move(at));
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
    Measurement at = Measure("constant", signal, runs.front(), WholeRun(runs.front()), steps);
    at.recording.clear();
    at.reason = "the drive has one value in all recordings while the joint moves.";
    at.remedy = "Map the column that holds the drive.";
    out->push_back(std::move(at));
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
      const double steps = SmallestStep(x) > 0.0 ? Range(x) / SmallestStep(x) : 0.0;
      Measurement at =
          Measure("duplicated", b->first, run, WholeRun(run), steps > 20.0 ? share : 0.0);
      at.reason = "it is the same column as " + std::string(types::SignalName(a->first)) + ".";
      at.remedy = "Map each signal to its own column.";
      out->push_back(std::move(at));
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
      Measurement at = Measure("recording_differs", signal, run, WholeRun(run),
                               IsUnitFactor(factor) ? std::max(both, 1.0) : 1.0);
      at.reason = "its steps are " + Number(factor) + " times as large as in the other recordings.";
      at.remedy = "Give this file a mapping of its own, with the unit of its column.";
      out.push_back(std::move(at));
    }
  }
  return out;
}

}  // namespace sinew::gate
