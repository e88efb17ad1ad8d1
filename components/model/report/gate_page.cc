#include <algorithm>
#include <cmath>

#include "components/model/gate/channels.h"
#include "components/model/gate/rules.h"
#include "components/model/report/page_parts.h"

namespace sinew::report {

namespace {

using gate::Fault;
using types::Run;
using types::Signal;

constexpr std::size_t kMostFaults = 6, kMostRecordings = 4;

constexpr int kPanel_px = 165;

// Panels over the recording's time from its start.
Picture Stack(const std::string& title, const std::string& caption, const Run& run,
              std::vector<Panel> panels) {
  for (Panel& panel : panels) {
    for (Series& line : panel.series) {
      for (double& x : line.x) x -= run.time_s[0];
    }
  }
  return Chart(title, caption, "time from the start, s", kPanel_px, panels);
}

std::string Label(Signal signal, types::JointKind kind) {
  std::string name(types::SignalName(signal));
  std::replace(name.begin(), name.end(), '_', ' ');
  return name + ", " + std::string(types::SignalUnit(signal, kind));
}

Series RowsOf(const Run& run, Signal signal, Eigen::Index first, Eigen::Index last,
              const char* colour, const std::string& name) {
  Series out = {name, colour, {}, {}};
  const Eigen::VectorXd& x = run.At(signal);
  for (Eigen::Index i = first; i <= last; ++i) {
    if (!std::isfinite(x[i]) || !std::isfinite(run.time_s[i])) continue;
    out.Add(run.time_s[i], x[i]);
  }
  return out;
}

std::optional<Signal> FirstOf(std::initializer_list<Signal> signals, const Run& run) {
  for (const Signal signal : signals) {
    if (run.Has(signal)) return signal;
  }
  return std::nullopt;
}

std::optional<Signal> DriveOf(const Run& run) {
  return FirstOf({Signal::kMotorCurrent, Signal::kDriveVoltage, Signal::kTorque}, run);
}

std::optional<Signal> AngleOf(const Run& run) {
  return FirstOf({Signal::kPosition, Signal::kMotorPosition}, run);
}

std::string TitleOf(const Fault& fault) {
  return fault.rule + ": " + fault.signal +
         (fault.recording.empty() ? "" : " of " + fault.recording);
}

// The channel around its faulty rows, and the angle beside it.
Picture AtRows(const Fault& fault, const Run& run, Signal signal) {
  const Eigen::Index around = std::max<Eigen::Index>(40, fault.last_row - fault.first_row + 1);
  const Eigen::Index first = std::max<Eigen::Index>(0, fault.first_row - around);
  const Eigen::Index last = std::min(run.size() - 1, fault.last_row + around);
  Series wrong =
      RowsOf(run, signal, fault.first_row, fault.last_row, kBeforeColour, "rows of the fault");
  wrong.style = "points pt 7 ps 0.8";
  const Series all = RowsOf(run, signal, first, last, kMeasuredColour, "as recorded");
  std::vector<Panel> panels = {{Label(signal, run.kind), {all, wrong}}};
  std::optional<Signal> beside = AngleOf(run);
  if (beside == signal) {
    beside = run.Has(Signal::kMotorPosition) && signal == Signal::kPosition
                 ? std::optional(Signal::kMotorPosition)
                 : DriveOf(run);
  }
  if (beside && *beside != signal) {
    panels.push_back(
        {Label(*beside, run.kind), {RowsOf(run, *beside, first, last, kAfterColour, "")}});
  }
  return Stack(TitleOf(fault), fault.reason, run, panels);
}

// Two speeds that should be one.
Picture Speeds(const Fault& fault, const Run& run, const actuator::JointModel& model) {
  const bool gear = fault.rule.ends_with("gear");
  const Signal measured = *types::SignalFromName(fault.signal);
  const Signal angle = gear                            ? Signal::kPosition
                       : measured == Signal::kVelocity ? Signal::kPosition
                                                       : Signal::kMotorPosition;
  const double half = gate::HalfWidth_s(run, angle);
  std::vector<double> at = gate::Centres(run, half, 4000);
  const double end = at.empty() ? 0.0 : at.front() + 120.0 * half;
  while (!at.empty() && at.back() > end) at.pop_back();
  const auto local = gate::LocalCubics(run, {angle, measured}, half, at);
  Series derived = {
      gear ? "output, differentiated" : "its angle, differentiated", kAfterColour, at, {}};
  Series shown = {gear ? "motor over gear ratio" : "as recorded", kBeforeColour, at, {}};
  const double ratio = gear && model.constants.gear_ratio > 0.0 ? model.constants.gear_ratio : 1.0;
  for (std::size_t i = 0; i < at.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    derived.y.push_back(local.at(angle).rate[k]);
    shown.y.push_back(gear ? local.at(measured).rate[k] / ratio : local.at(measured).value[k]);
  }
  const std::string unit =
      run.kind == types::JointKind::kPrismatic && angle == Signal::kPosition ? "m/s" : "rad/s";
  return Stack(TitleOf(fault), fault.reason, run, {{"speed, " + unit, {derived, shown}}});
}

Picture Overview(const Run& run, const std::string& title, const std::string& caption) {
  std::vector<Panel> panels;
  for (const std::optional<Signal> signal : {AngleOf(run), DriveOf(run)}) {
    if (!signal) continue;
    panels.push_back({Label(*signal, run.kind),
                      {RowsOf(run, *signal, 0, run.size() - 1,
                              panels.empty() ? kAfterColour : kMeasuredColour, "")}});
  }
  return Stack(title, caption, run, panels);
}

bool Drawable(const Run& run) { return run.size() > 2 && (AngleOf(run) || DriveOf(run)); }

}  // namespace

std::string VerdictWord(const gate::GateReport& gate) { return gate.stops() ? "data_fault" : "ok"; }

std::string VerdictSentence(const gate::GateReport& gate) {
  const auto accepted = std::count_if(gate.faults.begin(), gate.faults.end(),
                                      [](const Fault& at) { return at.accepted; });
  const auto open = static_cast<std::ptrdiff_t>(gate.faults.size()) - accepted;
  if (open == 0) {
    return accepted == 0
               ? "The data have no fault."
               : "The data have no fault beside the " + std::to_string(accepted) + " accepted.";
  }
  const Fault& first = *std::find_if(gate.faults.begin(), gate.faults.end(),
                                     [](const Fault& at) { return !at.accepted; });
  return "The data have " + std::to_string(open) + (open == 1 ? " fault: " : " faults, first: ") +
         gate::FormatFault(first);
}

std::vector<Picture> MakePictures(const gate::GateReport& gate, const std::vector<Run>& runs,
                                  const actuator::JointModel& model) {
  std::vector<Picture> out;
  for (const Fault& fault : gate.faults) {
    if (out.size() >= kMostFaults) break;
    const auto run = std::find_if(runs.begin(), runs.end(), [&](const Run& at) {
      return at.name == fault.recording || fault.recording.empty();
    });
    const auto signal = types::SignalFromName(fault.signal);
    if (run == runs.end() || !Drawable(*run)) continue;
    const bool speeds = fault.rule.ends_with("_speed") || fault.rule.ends_with("_gear");
    const bool whole =
        fault.last_row < fault.first_row || fault.last_row - fault.first_row + 1 >= run->size();
    if (speeds && signal) {
      out.push_back(Speeds(fault, *run, model));
    } else if (signal && run->Has(*signal) && !whole) {
      out.push_back(AtRows(fault, *run, *signal));
    } else if (fault.rule != "missing_constant" && fault.rule != "stamps") {
      out.push_back(Overview(*run, TitleOf(fault), fault.reason));
    }
  }
  for (std::size_t i = 0, drawn = 0; i < runs.size() && drawn < kMostRecordings; ++i) {
    if (!Drawable(runs[i])) continue;
    out.push_back(
        Overview(runs[i], runs[i].name,
                 "Angle and drive as recorded, " + std::to_string(runs[i].size()) + " rows."));
    ++drawn;
  }
  return out;
}

Page MakeCheckPage(const Report& report, std::vector<Picture> pictures) {
  std::vector<Recording> recordings = report.train;
  recordings.insert(recordings.end(), report.held_out.begin(), report.held_out.end());
  Section rules = TableSection("Largest statistic of each rule",
                               {"rule", "statistic", "limit", "largest here", "where"}, "", true);
  for (const gate::Measurement& at : report.gate.largest) {
    rules.Add({at.rule, std::string(gate::FindRule(at.rule).statistic), Short(at.limit),
               Short(at.statistic),
               at.signal + (at.recording.empty() ? "" : " of " + at.recording)});
  }
  return {.title = "Data check: " + report.robot + ", " + report.joint,
          .meta = NamesOf(recordings) + ". Model " + report.model_file + ".",
          .verdict = VerdictWord(report.gate),
          .outcome = VerdictWord(report.gate),
          .sentence = VerdictSentence(report.gate),
          .sections = {FaultSection(report.gate),
                       {.pictures = std::move(pictures)},
                       DataSection(report.gate),
                       std::move(rules)}};
}

}  // namespace sinew::report
