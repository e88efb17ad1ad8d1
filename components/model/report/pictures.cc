#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "components/model/identify/balance.h"
#include "components/model/identify/statistics.h"
#include "components/model/report/report.h"
#include "components/model/report/section.h"

namespace sinew::report {

namespace {

using effects::JointSample;
using identify::Design;

constexpr double kShown_s = 10.0;  // of a recording in the picture

struct Axis {
  std::string name;
  std::string label;
  std::function<double(const JointSample&)> get;
};

Axis AxisFor(const std::string& variable, types::JointKind kind) {
  struct Known {
    const char* start;  // of the variable's name
    const char* label;  // @: the unit of an angle
    double JointSample::*value;
  };
  static constexpr Known kKnown[] = {
      {"position_rad", "position, @", &JointSample::position_rad},
      {"motor_position_rad", "motor angle within a turn, rad", &JointSample::motor_position_rad},
      {"pressure_bar", "pressure, bar", &JointSample::pressure_bar},
      {"pressure_rate_bar_s", "rate of pressure, bar/s", &JointSample::pressure_rate_bar_s},
      {"drive_input", "drive input", &JointSample::drive_input},
      {"drive_rate", "rate of the drive input", &JointSample::drive_rate},
      {"jerk_rad_s3", "jerk, @/s^3", &JointSample::jerk_rad_s3},
      {"acceleration", "acceleration, @/s^2", &JointSample::acceleration_rad_s2},
      {"motor_acceleration", "acceleration, @/s^2", &JointSample::acceleration_rad_s2},
      {"temperature_degC", "temperature, degC", &JointSample::temperature_degC},
      {"time_s", "time from the start, s", &JointSample::time_s},
      {"load_force_N", "load force, N", &JointSample::load_force_N}};
  Known found = {"velocity_rad_s", "velocity, @/s", &JointSample::velocity_rad_s};
  for (const Known& known : kKnown) {
    if (variable.starts_with(known.start)) found = known;
  }
  std::string label = found.label;
  const std::size_t at = label.find('@');
  if (at != std::string::npos) {
    label.replace(at, 1, kind == types::JointKind::kRevolute ? "rad" : "m");
  }
  const auto value = found.value;
  const bool turns = value == &JointSample::motor_position_rad;
  return {found.start, label, [value, turns](const JointSample& x) {
            return turns ? std::remainder(x.*value, 2.0 * std::numbers::pi) : x.*value;
          }};
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

// Series of the refitted and, where an effect was added, of the corrected model.
std::vector<Series> BothModels(const Report& report, const std::string& style) {
  std::vector<Series> out = {{"refitted", kBeforeColour, {}, {}, style}};
  if (HasCorrection(report.trace)) out.push_back({"corrected", kAfterColour, {}, {}, style});
  return out;
}

void AddPoint(double x, double before, double after, std::vector<Series>* both) {
  for (std::size_t k = 0; k < both->size(); ++k) (*both)[k].Add(x, k == 0 ? before : after);
}

constexpr double kGapInLine = std::numeric_limits<double>::quiet_NaN();

// Measured, both models and their residuals over the whole of the held-out recordings, which follow
// each other a second apart; shown at first from row `first` on.
Traces WholeRecording(const Report& report, const Design& held_out, const Eigen::VectorXd& torque,
                      Eigen::Index first, double window_s) {
  const identify::Rows& rows = held_out.rows();
  const trace::TraceResult& trace = report.trace;
  const std::string unit = TorqueUnit(trace.corrected.kind);
  Traces out = {.x_label = "time from the start, s"};
  Panel drive = {"drive, " + unit, {{"measured", kMeasuredColour}}};
  Panel residual = {"residual, " + unit, {}};
  for (Panel* panel : {&drive, &residual}) {
    for (Series& model : BothModels(report, "")) panel->series.push_back(std::move(model));
  }
  double offset = -rows.time_s[0];
  for (Eigen::Index i = 0; i < rows.size(); ++i) {
    const bool begins = i > 0 && rows.segment[static_cast<std::size_t>(i)] !=
                                     rows.segment[static_cast<std::size_t>(i - 1)];
    if (begins) {
      if (rows.time_s[i] <= rows.time_s[i - 1]) offset += 1.0 + rows.time_s[i - 1] - rows.time_s[i];
      out.x.push_back(0.5 * (out.x.back() + rows.time_s[i] + offset));
      for (Panel* panel : {&drive, &residual}) {
        for (Series& series : panel->series) series.y.push_back(kGapInLine);
      }
    }
    out.x.push_back(rows.time_s[i] + offset);
    if (i == first) out.from = out.x.back();
    const double unused = rows.used[static_cast<std::size_t>(i)] ? 0.0 : kGapInLine;
    drive.series[0].y.push_back(torque[i]);
    const double left[] = {trace.before_held_out.residual[i] + unused,
                           trace.after_held_out.residual[i] + unused};
    for (std::size_t k = 0; k < residual.series.size(); ++k) {
      residual.series[k].y.push_back(left[k]);
      drive.series[k + 1].y.push_back(torque[i] - left[k]);
    }
  }
  out.to = out.from + window_s;
  out.panels = {std::move(drive), std::move(residual)};
  return out;
}

Picture MeasuredAgainstModel(const Report& report, const Design& held_out,
                             const Eigen::VectorXd& torque) {
  const identify::Rows& rows = held_out.rows();
  const trace::TraceResult& trace = report.trace;
  const double window_s = WindowLength(held_out);
  const Eigen::Index first = BusiestRow(held_out, torque, window_s);
  Series measured = {"measured", kMeasuredColour, {}, {}, "lines lw 3"};
  std::vector<Series> models = BothModels(report, "lines lw 1.6");
  for (Eigen::Index i = first; i < rows.size() && rows.segment[static_cast<std::size_t>(i)] ==
                                                      rows.segment[static_cast<std::size_t>(first)];
       ++i) {
    if (rows.time_s[i] > rows.time_s[first] + window_s) break;
    const double unused = rows.used[static_cast<std::size_t>(i)] ? 0.0 : kGapInLine;
    measured.Add(rows.time_s[i] - rows.time_s[0], torque[i]);
    AddPoint(measured.x.back(), torque[i] - trace.before_held_out.residual[i] + unused,
             torque[i] - trace.after_held_out.residual[i] + unused, &models);
  }
  models.insert(models.begin(), std::move(measured));
  Picture out = Chart("Measured against model, held-out recordings",
                      "Drive torque at the output, at first the busiest " + Short(window_s) +
                          " s. Gaps in the model: rest and reversals, which are excluded.",
                      "time from the start, s", 244,
                      {{"drive, " + TorqueUnit(trace.corrected.kind), std::move(models)}});
  out.traces = WholeRecording(report, held_out, torque, first, window_s);
  return out;
}

Picture ResidualOverTime(const Report& report, const Design& held_out) {
  const identify::Rows& rows = held_out.rows();
  const trace::TraceResult& trace = report.trace;
  const std::string unit = TorqueUnit(trace.corrected.kind);
  std::vector<Series> models = BothModels(report, "lines lw 1");
  for (Eigen::Index i = 0; i < rows.size(); ++i) {
    const double unused = rows.used[static_cast<std::size_t>(i)] ? 0.0 : kGapInLine;
    AddPoint(rows.time_s[i] - rows.time_s[0], trace.before_held_out.residual[i] + unused,
             trace.after_held_out.residual[i] + unused, &models);
  }
  return Chart("Residual over time, held-out recordings",
               "Residual of the torque balance while the joint moves: " +
                   Short(trace.before_held_out.rms) + " " + unit + " rms refitted, " +
                   Short(trace.after_held_out.rms) + " " + unit + " rms corrected.",
               "time from the start, s", 204, {{"residual, " + unit, std::move(models)}});
}

// Means of the residuals over bins with equal numbers of rows.
void AddMeans(const Eigen::VectorXd& x, const std::vector<Eigen::Index>& used, std::size_t most,
              const Eigen::VectorXd& before, const Eigen::VectorXd& after,
              std::vector<Series>* means) {
  std::vector<std::pair<double, Eigen::Index>> sorted;
  sorted.reserve(used.size());
  for (const Eigen::Index i : used) sorted.emplace_back(x[i], i);
  std::sort(sorted.begin(), sorted.end());
  const std::size_t bins = std::min<std::size_t>(most, sorted.size() / 20 + 1);
  for (std::size_t b = 0; b < bins; ++b) {
    const std::size_t from = b * sorted.size() / bins, to = (b + 1) * sorted.size() / bins;
    if (to <= from) continue;
    double mx = 0.0, mb = 0.0, ma = 0.0;
    for (std::size_t k = from; k < to; ++k) {
      mx += sorted[k].first;
      mb += before[sorted[k].second];
      ma += after[sorted[k].second];
    }
    const double n = static_cast<double>(to - from);
    AddPoint(mx / n, mb / n, ma / n, means);
  }
}

Picture ResidualOverVariable(const Report& report, const Design& design, const Axis& axis,
                             const Eigen::VectorXd& before, const Eigen::VectorXd& after) {
  const std::vector<Eigen::Index> used = design.rows().UsedRows();
  Eigen::VectorXd x = design.Variable(axis.get);
  if (axis.name == "time_s") x.array() -= x[0];
  Series rows = {"refitted, every row", "#f0b98a", {}, {}, "points pt 7 ps 0.28"};
  for (const Eigen::Index i : used) rows.Add(x[i], before[i]);
  std::vector<Series> series = BothModels(report, "linespoints pt 7 ps 0.4 lw 2");
  for (Series& mean : series) mean.name += ", mean";
  // Within a motor turn there may be many periods.
  AddMeans(x, used, axis.name == "motor_position_rad" ? 180 : 24, before, after, &series);
  series.insert(series.begin(), std::move(rows));
  std::vector<double> sizes;
  sizes.reserve(used.size());
  for (const Eigen::Index i : used) sizes.push_back(std::abs(before[i]));
  const std::string limit = PictureNumber(1.3 * identify::Quantile(sizes, 0.995));
  return Chart(
      "Residual against " + axis.label.substr(0, axis.label.find(',')) + ", training recordings",
      "Dots: residual of the refitted declared model; lines: means over equal numbers of rows.",
      axis.label, 244,
      {{"residual, " + TorqueUnit(report.trace.corrected.kind), std::move(series),
        "-" + limit + ":" + limit}});
}

// Amplitude of a residual at an order of an angle: sine and cosine by least squares over the used
// rows.
double Amplitude(const Eigen::VectorXd& residual, const Eigen::VectorXd& angle, double order,
                 const std::vector<Eigen::Index>& used) {
  double ss = 0.0, cc = 0.0, sc = 0.0, sy = 0.0, cy = 0.0;
  for (const Eigen::Index i : used) {
    const double s = std::sin(order * angle[i]), c = std::cos(order * angle[i]);
    ss += s * s;
    cc += c * c;
    sc += s * c;
    sy += s * residual[i];
    cy += c * residual[i];
  }
  const double determinant = ss * cc - sc * sc;
  if (!(determinant > 1e-9 * ss * cc)) return 0.0;
  return std::hypot((cc * sy - sc * cy) / determinant, (ss * cy - sc * sy) / determinant);
}

Picture SpectrumByAngle(const Report& report, const Design& design, const Eigen::VectorXd& before,
                        const Eigen::VectorXd& after) {
  const bool motor = design.states().measured.contains("motor_position_rad");
  const Eigen::VectorXd angle = design.Variable(
      [&](const JointSample& x) { return motor ? x.motor_position_rad : x.position_rad; });
  const std::vector<Eigen::Index> used = design.rows().UsedRows();
  constexpr int kOrders = 45;
  constexpr int kParts = 2;  // of an order
  std::vector<Series> models = BothModels(report, "lines lw 1.6");
  for (int k = 1; k <= kOrders * kParts; ++k) {
    const double order = static_cast<double>(k) / kParts;
    AddPoint(order, Amplitude(before, angle, order, used), Amplitude(after, angle, order, used),
             &models);
  }
  const std::string turn = motor ? "motor" : "output";
  return Chart(
      "Spectrum of the residual by angle, training recordings",
      "Amplitude at every order of the " + turn +
          "'s turn: torques that repeat with the angle (cogging, teeth, eccentric gears) "
          "appear as lines.",
      "periods per turn of the " + turn, 204,
      {{"amplitude, " + TorqueUnit(report.trace.corrected.kind), std::move(models), "0:*"}});
}

Picture Candidates(std::vector<trace::CandidateScore> shown) {
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
  return {"Candidates",
          "Part of the whitened misfit that each candidate removes by itself. Coloured: selected.",
          PictureHead(70 + 30 * std::max(3, count)) + data +
              "unset key\nset grid noy x\nset ytics textcolor rgb '#333333'\nset yrange [0.3:" +
              PictureNumber(count + 0.7) +
              "]\nset xlabel 'misfit removed, %'\n"
              "col(c) = c == 1 ? 0x1b7f9e : 0xc9c9c9\n"
              "plot $c u (0):1:(0):2:($1-0.3):($1+0.3):(col($4)):ytic(3) w boxxyerror fs solid 1 "
              "noborder lc rgb variable\n"};
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
  const std::string floor = PictureNumber(trace.noise_floor_rms);
  return {
      "Error, refitted and corrected",
      "Root mean square of the residual. Dashed: noise floor (" +
          (trace.noise_floor_source.empty() ? std::string("unknown") : trace.noise_floor_source) +
          ").",
      PictureHead(300) + data +
          "set style fill solid 1 noborder\nset boxwidth 0.32\nset xrange [-0.6:" +
          PictureNumber(at - 0.4) + "]\nset yrange [0:*]\nset grid nox\nset ylabel 'residual, " +
          unit + "'\nset arrow from graph 0, first " + floor + " to graph 1, first " + floor +
          " nohead dt 2 lw 1.5 lc rgb '#777777' front\n" +
          "plot $e u ($1-0.17):3:xtic(2) w boxes lc rgb '#bdbdbd' t 'training', '' u "
          "($1+0.17):4 w boxes "
          "lc rgb '" +
          kAfterColour + "' t 'held out'\n"};
}

// Pictures of the torque balance: of the motion, not of a simulation.
std::vector<Picture> PicturesOfBalance(const Report& report, const Design& train,
                                       const Design& held_out) {
  const trace::TraceResult& trace = report.trace;
  const identify::Balance balance = identify::MakeBalance(held_out, trace.corrected);
  std::string variable = trace.unexplained.variable;
  for (const trace::FoundEffect& effect : trace.effects) {
    if (effect.balance != effects::Balance::kMotion) continue;
    variable = effects::MakeEffect(effect.name, trace.corrected.constants)->info().variable;
    break;
  }
  std::vector<Picture> out = {
      MeasuredAgainstModel(report, held_out, balance.drive_factor * balance.drive_torque),
      ResidualOverTime(report, held_out),
      ResidualOverVariable(report, train, AxisFor(variable, trace.corrected.kind),
                           trace.before_train.residual, trace.after_train.residual)};
  if (trace.corrected.kind == types::JointKind::kRevolute) {
    out.push_back(
        SpectrumByAngle(report, train, trace.before_train.residual, trace.after_train.residual));
  }
  return out;
}

}  // namespace

Picture PathPicture(const free_run::FreeRunResult& following, types::JointKind kind,
                    std::size_t before, std::size_t after) {
  const bool rotary = kind == types::JointKind::kRevolute;
  const std::string unit = rotary ? "mrad" : "mm";
  const free_run::Trace& trace = following.traces.front();
  const auto rows =
      std::min(trace.measured.size(), static_cast<std::size_t>(kShown_s / trace.period_s) + 1);
  Panel path = {rotary ? "position, rad" : "position, m", {}}, off = {unit, {}};
  const auto add = [&](const char* name, const char* colour, const std::vector<double>& position) {
    Series series = {name, colour, {}, {}, "lines lw 1.6"};
    for (std::size_t i = 0; i < rows; ++i) {
      series.Add(trace.period_s * static_cast<double>(i), position[i]);
    }
    path.series.push_back(series);
    if (&position == &trace.measured) return;
    for (std::size_t i = 0; i < rows; ++i) series.y[i] = 1e3 * (series.y[i] - trace.measured[i]);
    off.series.push_back(std::move(series));
  };
  add("measured", kMeasuredColour, trace.measured);
  add("before", kBeforeColour, trace.simulated[before]);
  add("after", kAfterColour, trace.simulated[after]);
  for (Series& series : off.series) series.name.clear();
  return Chart("Simulated beside measured",
               "The first seconds; where a line begins anew the simulation started from the "
               "measured state again. Below: simulated less measured, " +
                   unit + ".",
               "time, s", 212, {std::move(path), std::move(off)});
}

std::vector<Picture> MakePictures(const Report& report, const Design& train,
                                  const Design& held_out) {
  std::vector<Picture> out;
  if (!report.trace.by_simulation) {
    out = PicturesOfBalance(report, train, held_out);
  } else if (!report.free_run.traces.empty()) {
    out.push_back(
        PathPicture(report.free_run, report.trace.corrected.kind, kRefittedModel, kCorrectedModel));
  }
  if (!report.trace.scores.empty()) out.push_back(Candidates(report.trace.scores));
  out.push_back(ErrorsBeforeAndAfter(report));
  return out;
}

}  // namespace sinew::report
