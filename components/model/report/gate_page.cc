#include "components/model/report/gate_page.h"

#include <algorithm>
#include <cmath>

#include "components/base/types/seconds.h"
#include "components/model/gate/channels.h"
#include "components/model/gate/rules.h"
#include "components/model/report/section.h"

namespace sinew::report {

namespace {

using gate::Fault;
using types::Run;
using types::Signal;

constexpr Eigen::Index kMostRows = 1800;  // of a line
constexpr std::size_t kMostFaults = 6, kMostRecordings = 4;

struct Line {
  std::string name;
  const char* colour;
  std::vector<double> x, y;
  bool points = false;
};

struct Panel {
  std::string label;
  std::vector<Line> lines;
};

std::string TimeRange(const std::vector<Panel>& panels) {
  double low = 0.0, high = 0.0;
  bool some = false;
  for (const Panel& panel : panels) {
    for (const Line& line : panel.lines) {
      for (const double x : line.x) {
        low = some ? std::min(low, x) : x;
        high = some ? std::max(high, x) : x;
        some = true;
      }
    }
  }
  return high > low ? "set xrange [" + PictureNumber(low) + ":" + PictureNumber(high) + "]\n" : "";
}

// Panels under each other, over the same time: the recording's, from its start.
Picture Stack(const std::string& title, const std::string& caption, const Run& run,
              std::vector<Panel> panels) {
  for (Panel& panel : panels) {
    for (Line& line : panel.lines) {
      for (double& x : line.x) x -= run.time_s[0];
    }
  }
  std::string data, plots;
  const auto count = panels.size();
  // Pixels: a line of text above, the axis with its name below, a gap between panels.
  constexpr double kAbove = 30.0, kBelow = 66.0, kPanel = 165.0, kGap = 18.0;
  const double height = kAbove + kBelow + kPanel * static_cast<double>(count);
  int number = 0;
  for (std::size_t p = 0; p < count; ++p) {
    const double top = height - kAbove - kPanel * static_cast<double>(p);
    plots += "set tmargin at screen " + PictureNumber(top / height) + "\nset bmargin at screen " +
             PictureNumber((top - kPanel + (p + 1 == count ? 0.0 : kGap)) / height) + "\n";
    plots += p + 1 == count ? "set format x '%g'\nset xlabel 'time from the start, s'\n"
                            : "set format x ''\nunset xlabel\n";
    plots += "set ylabel '" + panels[p].label + "'\nplot ";
    for (std::size_t l = 0; l < panels[p].lines.size(); ++l) {
      const Line& line = panels[p].lines[l];
      const std::string block = "$d" + std::to_string(number++);
      data += block + " << EOD\n";
      for (std::size_t i = 0; i < line.x.size(); ++i) {
        data += PictureNumber(line.x[i]) + " " + PictureNumber(line.y[i]) + "\n";
      }
      data += "EOD\n";
      plots += (l == 0 ? "" : ", ") + block + " using 1:2 with " +
               (line.points ? "points pt 7 ps 0.8" : "lines lw 1.2") + " lc rgb '" + line.colour +
               "' " + (line.name.empty() ? "notitle" : "title '" + line.name + "'");
    }
    plots += "\n";
  }
  Picture out;
  out.title = title;
  out.caption = caption;
  out.script = PictureHead(static_cast<int>(height)) + data + TimeRange(panels) +
               "set lmargin at screen 0.1\nset rmargin at screen 0.97\nset multiplot\n" + plots +
               "unset multiplot\n";
  return out;
}

std::string Label(Signal signal, types::JointKind kind) {
  std::string name(types::SignalName(signal));
  std::replace(name.begin(), name.end(), '_', ' ');
  return name + ", " + std::string(types::SignalUnit(signal, kind));
}

// Every k-th row, so that a line stays a line; rows of a fault keep all of theirs.
Line RowsOf(const Run& run, Signal signal, Eigen::Index first, Eigen::Index last,
            const char* colour, const std::string& name) {
  Line out{name, colour, {}, {}, false};
  const Eigen::VectorXd& x = run.At(signal);
  const Eigen::Index stride = std::max<Eigen::Index>(1, (last - first + 1) / kMostRows);
  for (Eigen::Index i = first; i <= last; i += stride) {
    if (!std::isfinite(x[i]) || !std::isfinite(run.time_s[i])) continue;
    out.x.push_back(run.time_s[i]);
    out.y.push_back(x[i]);
  }
  return out;
}

std::optional<Signal> DriveOf(const Run& run) {
  for (const Signal signal : {Signal::kMotorCurrent, Signal::kDriveVoltage, Signal::kTorque}) {
    if (run.Has(signal)) return signal;
  }
  return std::nullopt;
}

std::optional<Signal> AngleOf(const Run& run) {
  for (const Signal signal : {Signal::kPosition, Signal::kMotorPosition}) {
    if (run.Has(signal)) return signal;
  }
  return std::nullopt;
}

// The channel around its faulty rows, and the angle beside it.
Picture AtRows(const Fault& fault, const Run& run, Signal signal) {
  const Eigen::Index around = std::max<Eigen::Index>(40, fault.last_row - fault.first_row + 1);
  const Eigen::Index first = std::max<Eigen::Index>(0, fault.first_row - around);
  const Eigen::Index last = std::min(run.size() - 1, fault.last_row + around);
  Line wrong =
      RowsOf(run, signal, fault.first_row, fault.last_row, kBeforeColour, "rows of the fault");
  wrong.points = true;
  Line all = RowsOf(run, signal, first, last, kMeasuredColour, "as recorded");
  if (fault.last_row - fault.first_row < 3) all.points = false;
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
  return Stack(fault.rule + ": " + fault.signal + " of " + fault.recording, fault.reason, run,
               panels);
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
  Line derived{
      gear ? "output, differentiated" : "its angle, differentiated", kAfterColour, at, {}, false};
  Line shown{gear ? "motor over gear ratio" : "as recorded", kBeforeColour, at, {}, false};
  const double ratio = gear && model.constants.gear_ratio > 0.0 ? model.constants.gear_ratio : 1.0;
  for (std::size_t i = 0; i < at.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    derived.y.push_back(local.at(angle).rate[k]);
    shown.y.push_back(gear ? local.at(measured).rate[k] / ratio : local.at(measured).value[k]);
  }
  const std::string unit =
      run.kind == types::JointKind::kLinear && angle == Signal::kPosition ? "m/s" : "rad/s";
  return Stack(fault.rule + ": " + fault.signal + " of " + fault.recording, fault.reason, run,
               {{"speed, " + unit, {derived, shown}}});
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
      out.push_back(Overview(*run,
                             fault.rule + ": " + fault.signal +
                                 (fault.recording.empty() ? "" : " of " + fault.recording),
                             fault.reason));
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

std::string FormatFaultTable(const std::vector<Fault>& faults) {
  if (faults.empty()) return "";
  std::string out = "<h2>Faults of the data</h2>\n<div class=\"wide\"><table>" +
                    HtmlRow({"rule", "where", "statistic", "limit", "reason", "remedy"}, "th");
  for (const Fault& fault : faults) {
    std::string where = Escape(fault.signal);
    if (!fault.recording.empty()) where += (where.empty() ? "" : "<br>") + Escape(fault.recording);
    if (fault.last_row >= fault.first_row && !fault.recording.empty()) {
      where += "<br>rows " + std::to_string(fault.first_row) + " to " +
               std::to_string(fault.last_row) + ", " + types::SecondsText(fault.from_s) + " to " +
               types::SecondsText(fault.to_s) + " s";
    }
    const std::string accept = fault.accepted ? "accepted"
                                              : "to continue in spite of it: <code>" +
                                                    Escape(gate::AcceptOption(fault)) + "</code>";
    out += HtmlRow({"<code>" + Escape(fault.rule) + "</code><br>" + accept, where,
                    Short(fault.statistic), Short(fault.limit), Escape(fault.reason),
                    Escape(fault.remedy)});
  }
  return out + "</table></div>\n";
}

std::string FormatHtml(const DataCheck& check, const std::vector<Picture>& pictures,
                       const std::vector<std::string>& svgs) {
  std::string out = HtmlHead("Data check: " + check.robot);
  out += "<h1>Data check: " + Escape(check.robot) + ", " + Escape(check.joint) + "</h1>\n";
  std::string names;
  for (const auto* list : {&check.train, &check.held_out}) {
    for (const Recording& recording : *list) {
      names += (names.empty() ? "" : ", ") + Escape(recording.name);
    }
  }
  out += "<div class=\"meta\">" + names + ". Model " + Escape(check.model_file) + ".</div>\n";
  out += "<div class=\"verdict " + std::string(check.gate.stops() ? "unexplained" : "none") +
         "\">" + Escape(VerdictSentence(check.gate)) + "</div>\n";
  out += FormatFaultTable(check.gate.faults);
  for (std::size_t i = 0; i < pictures.size() && i < svgs.size(); ++i) {
    out += "<figure><h3>" + Escape(pictures[i].title) + "</h3>" + svgs[i] +
           "<p class=\"caption\">" + Escape(pictures[i].caption) + "</p></figure>\n";
  }
  out += "<h2>Findings</h2>\n<ul>";
  for (const identify::Finding& finding : check.gate.findings) {
    out += "<li>" + Escape(finding.text) + "</li>\n";
  }
  out += "</ul>\n<h2>Largest statistic of each rule</h2>\n<div class=\"wide\"><table>" +
         HtmlRow({"rule", "statistic", "limit", "largest here", "where"}, "th");
  for (const gate::Measurement& at : check.gate.largest) {
    const gate::Rule& rule = gate::FindRule(at.rule);
    out += HtmlRow({"<code>" + Escape(at.rule) + "</code>", Escape(std::string(rule.statistic)),
                    Short(at.limit), Short(at.statistic),
                    Escape(at.signal + (at.recording.empty() ? "" : " of " + at.recording))});
  }
  return out + "</table></div>\n</main></body></html>\n";
}

}  // namespace sinew::report
