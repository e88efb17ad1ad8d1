#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

#include "components/model/identify/balance.h"
#include "components/model/identify/statistics.h"
#include "components/model/report/report.h"
#include "components/model/report/section.h"

namespace sinew::report {

namespace {

using effects::JointSample;
using identify::Design;

constexpr int kMostPoints = 2500;
constexpr double kShown_s = 10.0;  // of a recording in the picture

struct Axis {
  std::string name;
  std::string label;
  std::function<double(const JointSample&)> get;
};

Axis AxisFor(const std::string& variable, types::JointKind kind) {
  const bool rotary = kind == types::JointKind::kRotary;
  const std::string angle = rotary ? "rad" : "m";
  if (variable == "position_rad") {
    return {variable, "position, " + angle, [](const JointSample& x) { return x.position_rad; }};
  }
  if (variable == "motor_position_rad") {
    return {variable, "motor angle within a turn, rad", [](const JointSample& x) {
              return std::remainder(x.motor_position_rad, 6.283185307179586);
            }};
  }
  if (variable == "pressure_bar") {
    return {variable, "pressure, bar", [](const JointSample& x) { return x.pressure_bar; }};
  }
  if (variable == "pressure_rate_bar_s") {
    return {variable, "rate of pressure, bar/s",
            [](const JointSample& x) { return x.pressure_rate_bar_s; }};
  }
  if (variable == "drive_input") {
    return {variable, "drive input", [](const JointSample& x) { return x.drive_input; }};
  }
  if (variable == "drive_rate") {
    return {variable, "rate of the drive input", [](const JointSample& x) { return x.drive_rate; }};
  }
  if (variable == "jerk_rad_s3") {
    return {variable, "jerk, " + angle + "/s^3",
            [](const JointSample& x) { return x.jerk_rad_s3; }};
  }
  if (variable.starts_with("acceleration") || variable.starts_with("motor_acceleration")) {
    return {variable, "acceleration, " + angle + "/s^2",
            [](const JointSample& x) { return x.acceleration_rad_s2; }};
  }
  if (variable == "temperature_degC") {
    return {variable, "temperature, degC", [](const JointSample& x) { return x.temperature_degC; }};
  }
  if (variable == "time_s") {
    return {variable, "time from the start, s", [](const JointSample& x) { return x.time_s; }};
  }
  if (variable == "load_force_N") {
    return {variable, "load force, N", [](const JointSample& x) { return x.load_force_N; }};
  }
  return {"velocity_rad_s", "velocity, " + angle + "/s",
          [](const JointSample& x) { return x.velocity_rad_s; }};
}

// Seconds that a picture can show line by line.
double WindowLength(const Design& design) {
  return std::clamp(700.0 / design.rows_per_s(), 3.0, 20.0);
}

// Start of the busiest window of a run's rows: most used rows and largest drive.
Eigen::Index BusiestRow(const Design& design, const Eigen::VectorXd& torque, double window_s) {
  const identify::Rows& rows = design.rows();
  double best = -1.0;
  Eigen::Index start = 0;
  const auto step = static_cast<Eigen::Index>(std::max(1.0, design.rows_per_s()));
  for (Eigen::Index i = 0; i < rows.size(); i += step) {
    double sum = 0.0;
    Eigen::Index k = i;
    for (; k < rows.size() &&
           rows.segment[static_cast<std::size_t>(k)] == rows.segment[static_cast<std::size_t>(i)] &&
           rows.time_s[k] < rows.time_s[i] + window_s;
         ++k) {
      if (rows.used[static_cast<std::size_t>(k)]) sum += torque[k] * torque[k];
    }
    if (rows.time_s[k - 1] - rows.time_s[i] > 0.8 * window_s && sum > best) {
      best = sum;
      start = i;
    }
  }
  return start;
}

Picture MeasuredAgainstModel(const Report& report, const Design& held_out,
                             const Eigen::VectorXd& torque) {
  const identify::Rows& rows = held_out.rows();
  const trace::TraceResult& trace = report.trace;
  const std::string unit = TorqueUnit(trace.corrected.kind);
  const bool changed = HasCorrection(trace);
  const double window_s = WindowLength(held_out);
  const Eigen::Index first = BusiestRow(held_out, torque, window_s);
  std::string data = "$d << EOD\n";
  for (Eigen::Index i = first; i < rows.size() && rows.segment[static_cast<std::size_t>(i)] ==
                                                      rows.segment[static_cast<std::size_t>(first)];
       ++i) {
    if (rows.time_s[i] > rows.time_s[first] + window_s) break;
    const bool used = rows.used[static_cast<std::size_t>(i)];
    data += PictureNumber(rows.time_s[i] - rows.time_s[0]) + " " + PictureNumber(torque[i]) + " " +
            (used ? PictureNumber(torque[i] - trace.before_held_out.residual[i]) : "NaN") + " " +
            (used ? PictureNumber(torque[i] - trace.after_held_out.residual[i]) : "NaN") + "\n";
  }
  data += "EOD\n";
  Picture out;
  out.title = "Measured against model, held-out recordings";
  out.caption = "Drive torque at the output, busiest " + Short(window_s) +
                " s. Gaps in the model: rest and reversals, which are excluded.";
  out.script =
      PictureHead(340) + data + "set xlabel 'time from the start, s'\nset ylabel 'drive, " + unit +
      "'\n" + "plot $d u 1:2 w l lw 3 lc rgb '" + kMeasuredColour +
      "' t 'measured', '' u 1:3 w l lw 1.6 lc rgb '" + kBeforeColour + "' t 'refitted'" +
      (changed ? std::string(", '' u 1:4 w l lw 1.6 lc rgb '") + kAfterColour + "' t 'corrected'"
               : "") +
      "\n";
  return out;
}

Picture ResidualOverTime(const Report& report, const Design& held_out) {
  const identify::Rows& rows = held_out.rows();
  const trace::TraceResult& trace = report.trace;
  const bool changed = HasCorrection(trace);
  const std::string unit = TorqueUnit(trace.corrected.kind);
  const Eigen::Index step = std::max<Eigen::Index>(1, rows.size() / kMostPoints);
  std::string data = "$d << EOD\n";
  for (Eigen::Index i = 0; i < rows.size(); i += step) {
    if (rows.used[static_cast<std::size_t>(i)]) {
      data += PictureNumber(rows.time_s[i] - rows.time_s[0]) + " " +
              PictureNumber(trace.before_held_out.residual[i]) + " " +
              PictureNumber(trace.after_held_out.residual[i]) + "\n";
    } else {
      data += "\n";
    }
  }
  data += "EOD\n";
  Picture out;
  out.title = "Residual over time, held-out recordings";
  out.caption =
      "Residual of the torque balance while the joint moves: " + Short(trace.before_held_out.rms) +
      " " + unit + " rms refitted, " + Short(trace.after_held_out.rms) + " " + unit +
      " rms corrected.";
  out.script =
      PictureHead(300) + data + "set xlabel 'time from the start, s'\nset ylabel 'residual, " +
      unit + "'\nplot $d u 1:2 w l lw 1 lc rgb '" + kBeforeColour + "' t 'refitted'" +
      (changed ? std::string(", '' u 1:3 w l lw 1 lc rgb '") + kAfterColour + "' t 'corrected'"
               : "") +
      "\n";
  return out;
}

Picture ResidualOverVariable(const Report& report, const Design& design, const Axis& axis,
                             const Eigen::VectorXd& before, const Eigen::VectorXd& after) {
  const trace::TraceResult& trace = report.trace;
  const std::string unit = TorqueUnit(trace.corrected.kind);
  const bool changed = HasCorrection(trace);
  const std::vector<Eigen::Index> used = design.rows().UsedRows();
  Eigen::VectorXd x = design.Variable(axis.get);
  if (axis.name == "time_s") x.array() -= x[0];
  const std::size_t step = std::max<std::size_t>(1, used.size() / kMostPoints);
  std::string points = "$p << EOD\n";
  for (std::size_t k = 0; k < used.size(); k += step) {
    points += PictureNumber(x[used[k]]) + " " + PictureNumber(before[used[k]]) + "\n";
  }
  points += "EOD\n";
  // Means over bins with equal numbers of rows.
  std::vector<std::pair<double, Eigen::Index>> sorted;
  sorted.reserve(used.size());
  for (const Eigen::Index i : used) sorted.emplace_back(x[i], i);
  std::sort(sorted.begin(), sorted.end());
  // Within a motor turn there may be many periods.
  const std::size_t most = axis.name == "motor_position_rad" ? 180 : 24;
  const std::size_t bins = std::min<std::size_t>(most, sorted.size() / 20 + 1);
  std::string means = "$m << EOD\n";
  for (std::size_t b = 0; b < bins; ++b) {
    const std::size_t from = b * sorted.size() / bins;
    const std::size_t to = (b + 1) * sorted.size() / bins;
    if (to <= from) continue;
    double mx = 0.0;
    double mb = 0.0;
    double ma = 0.0;
    for (std::size_t k = from; k < to; ++k) {
      mx += sorted[k].first;
      mb += before[sorted[k].second];
      ma += after[sorted[k].second];
    }
    const double n = static_cast<double>(to - from);
    means +=
        PictureNumber(mx / n) + " " + PictureNumber(mb / n) + " " + PictureNumber(ma / n) + "\n";
  }
  means += "EOD\n";
  std::vector<double> sizes;
  sizes.reserve(used.size());
  for (const Eigen::Index i : used) sizes.push_back(std::abs(before[i]));
  const double limit = 1.3 * identify::Quantile(sizes, 0.995);
  Picture out;
  out.title =
      "Residual against " + axis.label.substr(0, axis.label.find(',')) + ", training recordings";
  out.caption =
      "Dots: residual of the refitted declared model; lines: means over equal numbers of rows.";
  out.script = PictureHead(340) + points + means + "set xlabel '" + axis.label +
               "'\nset ylabel 'residual, " + unit + "'\nset yrange [" + PictureNumber(-limit) +
               ":" + PictureNumber(limit) +
               "]\nplot $p u 1:2 w p pt 7 ps 0.28 lc rgb '#f0b98a' t 'refitted, every row', $m u "
               "1:2 w lp pt "
               "7 "
               "ps 0.4 lw 2 lc rgb '" +
               kBeforeColour + "' t 'refitted, mean'" +
               (changed ? std::string(", '' u 1:3 w lp pt 7 ps 0.4 lw 2 lc rgb '") + kAfterColour +
                              "' t 'corrected, mean'"
                        : "") +
               "\n";
  return out;
}

// Amplitude of the residual at every order of the motor's (or output's) angle: sine and cosine by
// least squares over the used rows, one order at a time.
Picture SpectrumByAngle(const Report& report, const Design& design, const Eigen::VectorXd& before,
                        const Eigen::VectorXd& after) {
  const trace::TraceResult& trace = report.trace;
  const bool motor = design.states().measured.contains("motor_position_rad");
  const Eigen::VectorXd angle = design.Variable(
      [&](const JointSample& x) { return motor ? x.motor_position_rad : x.position_rad; });
  const std::vector<Eigen::Index> used = design.rows().UsedRows();
  constexpr int kOrders = 45;
  constexpr int kParts = 2;  // of an order
  const auto amplitude = [&](const Eigen::VectorXd& residual, double order) {
    double ss = 0.0, cc = 0.0, sc = 0.0, sy = 0.0, cy = 0.0;
    for (const Eigen::Index i : used) {
      const double s = std::sin(order * angle[i]);
      const double c = std::cos(order * angle[i]);
      ss += s * s;
      cc += c * c;
      sc += s * c;
      sy += s * residual[i];
      cy += c * residual[i];
    }
    const double determinant = ss * cc - sc * sc;
    if (!(determinant > 1e-9 * ss * cc)) return 0.0;
    return std::hypot((cc * sy - sc * cy) / determinant, (ss * cy - sc * sy) / determinant);
  };
  std::string data = "$d << EOD\n";
  for (int k = 1; k <= kOrders * kParts; ++k) {
    const double order = static_cast<double>(k) / kParts;
    data += PictureNumber(order) + " " + PictureNumber(amplitude(before, order)) + " " +
            PictureNumber(amplitude(after, order)) + "\n";
  }
  data += "EOD\n";
  Picture out;
  const std::string turn = motor ? "motor" : "output";
  out.title = "Spectrum of the residual by angle, training recordings";
  out.caption = "Amplitude at every order of the " + turn +
                "'s turn: torques that repeat with the angle (cogging, teeth, eccentric gears) "
                "appear as lines.";
  out.script =
      PictureHead(300) + data + "set xlabel 'periods per turn of the " + turn +
      "'\nset ylabel 'amplitude, " + TorqueUnit(trace.corrected.kind) +
      "'\nset yrange [0:*]\nplot $d u 1:2 w l lw 1.6 lc rgb '" + kBeforeColour + "' t 'refitted'" +
      (!HasCorrection(trace)
           ? ""
           : std::string(", '' u 1:3 w l lw 1.6 lc rgb '") + kAfterColour + "' t 'corrected'") +
      "\n";
  return out;
}

Picture Candidates(const trace::RoundReport& round) {
  std::vector<trace::CandidateScore> shown = round.scores;
  if (shown.size() > 10) shown.resize(10);
  std::string data = "$c << EOD\n";
  const auto count = static_cast<int>(shown.size());
  for (int i = 0; i < count; ++i) {
    const trace::CandidateScore& score = shown[static_cast<std::size_t>(i)];
    data += PictureNumber(count - i) + " " +
            PictureNumber(std::max(-20.0, 100.0 * score.gain_share)) + " \"" + score.name + "\" " +
            (score.accepted ? "1" : "0") + "\n";
  }
  data += "EOD\n";
  Picture out;
  out.title = "Candidates";
  out.caption =
      "Part of the whitened misfit that each candidate removes by itself. Coloured: selected.";
  out.script = PictureHead(70 + 30 * std::max(3, count)) + data +
               "unset key\nset grid noy x\nset ytics textcolor rgb '#333333'\nset yrange [0.3:" +
               PictureNumber(count + 0.7) +
               "]\nset xlabel 'misfit removed, %'\n"
               "col(c) = c == 1 ? 0x1b7f9e : 0xc9c9c9\n"
               "plot $c u (0):1:(0):2:($1-0.3):($1+0.3):(col($4)):ytic(3) w boxxyerror fs solid 1 "
               "noborder lc rgb variable\n";
  return out;
}

Picture ErrorsBeforeAndAfter(const Report& report) {
  const trace::TraceResult& trace = report.trace;
  const std::string unit = ErrorUnit(trace);
  std::string data = "$e << EOD\n";
  int at = 0;
  const auto add = [&](const std::string& name, double train, double held_out) {
    data += PictureNumber(at++) + " \"" + name + "\" " + PictureNumber(train) + " " +
            PictureNumber(held_out) + "\n";
  };
  add("refitted", trace.before_train.rms, trace.before_held_out.rms);
  if (HasCorrection(trace)) {
    for (const trace::FoundEffect& effect : trace.effects) {
      if (trace.effects.size() < 2 || !effect.in_model()) continue;
      if (effect.balance != effects::Balance::kMotion) continue;
      add("without " + EffectLabel(trace, effect), effect.train_before, effect.held_out_before);
    }
    add("corrected", trace.after_train.rms, trace.after_held_out.rms);
  }
  data += "EOD\n";
  Picture out;
  out.title = "Error, refitted and corrected";
  out.caption =
      "Root mean square of the residual. Dashed: noise floor (" +
      (trace.noise_floor_source.empty() ? std::string("unknown") : trace.noise_floor_source) + ").";
  const double floor = trace.noise_floor_rms;
  out.script = PictureHead(300) + data +
               "set style fill solid 1 noborder\nset boxwidth 0.32\nset xrange [-0.6:" +
               PictureNumber(at - 0.4) +
               "]\nset yrange [0:*]\nset grid nox\nset ylabel 'residual, " + unit +
               "'\nset arrow from graph 0, first " + PictureNumber(floor) + " to graph 1, first " +
               PictureNumber(floor) + " nohead dt 2 lw 1.5 lc rgb '#777777' front\n" +
               "plot $e u ($1-0.17):3:xtic(2) w boxes lc rgb '#bdbdbd' t 'training', '' u "
               "($1+0.17):4 w boxes "
               "lc rgb '" +
               kAfterColour + "' t 'held out'\n";
  return out;
}

// No torques: the simulated angle and what was searched for.
std::vector<Picture> PicturesOfSimulation(const Report& report) {
  std::vector<Picture> out;
  if (!report.free_run.traces.empty()) {
    out.push_back(
        PathPicture(report.free_run, report.trace.corrected.kind, kRefittedModel, kCorrectedModel));
  }
  if (!report.trace.rounds.empty() && !report.trace.rounds.front().scores.empty()) {
    out.push_back(Candidates(report.trace.rounds.front()));
  }
  out.push_back(ErrorsBeforeAndAfter(report));
  return out;
}

}  // namespace

Picture PathPicture(const free_run::FreeRunResult& following, types::JointKind kind,
                    std::size_t before, std::size_t after) {
  const bool rotary = kind == types::JointKind::kRotary;
  const std::string unit = rotary ? "mrad" : "mm";
  const free_run::Trace& trace = following.traces.front();
  const auto rows =
      std::min(trace.measured.size(), static_cast<std::size_t>(kShown_s / trace.period_s) + 1);
  std::string data = "$d << EOD\n";
  for (std::size_t i = 0; i < rows; ++i) {
    const auto number = [](double value) {
      return std::isfinite(value) ? PictureNumber(value) : std::string("NaN");
    };
    data += PictureNumber(trace.period_s * static_cast<double>(i)) + " " +
            number(trace.measured[i]) + " " + number(trace.simulated[before][i]) + " " +
            number(trace.simulated[after][i]) + " " +
            number(1e3 * (trace.simulated[before][i] - trace.measured[i])) + " " +
            number(1e3 * (trace.simulated[after][i] - trace.measured[i])) + "\n";
  }
  data += "EOD\n";
  Picture out;
  out.title = "Simulated beside measured";
  out.caption =
      "The first seconds; where a line begins anew the simulation started from the "
      "measured state again. Below: simulated less measured, " +
      unit + ".";
  const auto line = [](const char* columns, const char* colour, const char* title) {
    return std::string("$d u ") + columns + " w l lw 1.6 lc rgb '" + colour + "' t '" + title + "'";
  };
  out.script = PictureHead(520) + data + "set multiplot layout 2,1\nset ylabel 'position, " +
               (rotary ? "rad" : "m") + "'\nplot " + line("1:2", kMeasuredColour, "measured") +
               ", " + line("1:3", kBeforeColour, "before") + ", " +
               line("1:4", kAfterColour, "after") + "\nset xlabel 'time, s'\nset ylabel '" + unit +
               "'\nplot " + line("1:5", kBeforeColour, "before") + ", " +
               line("1:6", kAfterColour, "after") + "\nunset multiplot\n";
  return out;
}

std::vector<Picture> MakePictures(const Report& report, const Design& train,
                                  const Design& held_out) {
  const trace::TraceResult& trace = report.trace;
  if (trace.by_simulation) return PicturesOfSimulation(report);
  const identify::Balance balance = identify::MakeBalance(held_out, trace.corrected);
  const Eigen::VectorXd torque = balance.drive_factor * balance.drive_torque;
  std::string variable = trace.unexplained.variable;
  for (const trace::FoundEffect& effect : trace.effects) {
    if (effect.balance != effects::Balance::kMotion) continue;
    variable = effects::MakeEffect(effect.name, trace.corrected.constants)->info().variable;
    break;
  }
  std::vector<Picture> out;
  out.push_back(MeasuredAgainstModel(report, held_out, torque));
  out.push_back(ResidualOverTime(report, held_out));
  out.push_back(ResidualOverVariable(report, train, AxisFor(variable, trace.corrected.kind),
                                     trace.before_train.residual, trace.after_train.residual));
  if (trace.corrected.kind == types::JointKind::kRotary) {
    out.push_back(
        SpectrumByAngle(report, train, trace.before_train.residual, trace.after_train.residual));
  }
  if (!trace.rounds.empty() && !trace.rounds.front().scores.empty()) {
    out.push_back(Candidates(trace.rounds.front()));
  }
  out.push_back(ErrorsBeforeAndAfter(report));
  return out;
}

}  // namespace sinew::report
