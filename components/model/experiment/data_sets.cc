#include "components/model/experiment/data_sets.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "components/base/types/angle.h"
#include "components/base/types/control_mode.h"
#include "components/model/identify/statistics.h"

namespace sinew::experiment {
namespace {

constexpr double kPushing_N = 2.0;
constexpr double kFree_N = 0.5;

struct Cycle {
  std::size_t first = 0, last = 0;  // rows, from push to push
  bool came_back = false;
};

// From one rise of the force to the next.
std::vector<Cycle> FindCycles(const Recording& rows, double upper_rad, double width_rad) {
  std::vector<Cycle> cycles;
  bool pushing = false;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!pushing && rows[i].load_force_N > kPushing_N) {
      pushing = true;
      if (!cycles.empty()) cycles.back().last = i - 1;
      cycles.push_back({.first = i, .last = rows.size() - 1});
    } else if (pushing && rows[i].load_force_N < kFree_N) {
      pushing = false;
    }
  }
  for (Cycle& cycle : cycles) {
    bool down = false;
    for (std::size_t i = cycle.first; i <= cycle.last; ++i) {
      const double q = rows[i].output_angle_rad;
      if (q < upper_rad - 0.8 * width_rad) down = true;
      if (down && q > upper_rad - 0.2 * width_rad) cycle.came_back = true;
    }
  }
  return cycles;
}

struct Span {
  double lower_rad = 0.0, upper_rad = 0.0;
};
Span AngleSpan(const Recording& rows) {
  std::vector<double> angles;
  for (const Row& row : rows) angles.push_back(row.output_angle_rad);
  return {identify::Quantile(angles, 0.02), identify::Quantile(angles, 0.98)};
}

report::Picture TimeFigure(const Recording& rows, const std::string& title,
                           const std::string& label, double (*get)(const Row&)) {
  report::Series series;
  for (const Row& row : rows) {
    series.Add(row.time_s - rows.front().time_s, get(row));
  }
  return report::Chart(title, "", "time, s", kFigure_px, {{label, {std::move(series)}}});
}

// Fig 5.7: a point for each row, in space.
report::Picture SpaceFigure(const Recording& set, double length_m) {
  report::Picture out = {"Torque, pressure and angle (Fig 5.7)", "",
                         report::PictureHead(480) +
                             "set xlabel 'angle, degrees'\nset ylabel 'pressure, bar'\n"
                             "set zlabel 'torque, N m' rotate\nset view 62,40\n$d << EOD\n"};
  const std::size_t step = std::max<std::size_t>(1, set.size() / 2500);
  for (std::size_t i = 0; i < set.size(); i += step) {
    out.script += report::PictureNumber(set[i].output_angle_rad / types::kDegree_rad) + " " +
                  report::PictureNumber(set[i].chamber_pressure_bar) + " " +
                  report::PictureNumber(set[i].load_force_N * length_m) + "\n";
  }
  out.script += std::string("EOD\nsplot $d with points pt 7 ps 0.2 lc rgb '") +
                report::kMeasuredColour + "' notitle\n";
  return out;
}

}  // namespace

SeaProtocol::SeaProtocol(const SeaPlan& plan) : plan_(plan), person_(plan.seed) {
  if (!(plan.duration_s > 1.0) || !(plan.rate_Hz > 0.0) || !(plan.force_N > 0.0)) {
    throw std::invalid_argument("sea-data: duration, rate and force must be positive");
  }
  length_s_ = 1.0 / plan.rate_Hz;
  size_N_ = plan.force_N;
}

Command SeaProtocol::Step(const Reading& reading) noexcept {
  Command command;
  command.drive = types::ControlMode::kPosition;
  const double t = reading.time_s;
  if (t >= plan_.duration_s) {
    done_ = true;
    return command;
  }
  while (t >= stroke_s_ + length_s_) {
    stroke_s_ += length_s_;
    // A person keeps time and force to about a tenth.
    length_s_ = (1.0 + person_.Uniform(-0.1, 0.1)) / plan_.rate_Hz;
    size_N_ = plan_.force_N * (1.0 + person_.Uniform(-0.12, 0.12));
  }
  const double local_s = t - stroke_s_;
  if (local_s >= 0.0) {
    // Pushes for a little over half of the stroke.
    command.hand_force_N =
        size_N_ * std::max(0.0, std::sin(types::kTwoPi * local_s / length_s_) + 0.1) / 1.1;
  }
  // The leak is set so that the pressure falls evenly, as far as it can.
  const double planned_bar = plan_.first_bar * (1.0 - t / plan_.duration_s);
  command.vent_open = reading.reservoir_pressure_bar > planned_bar;
  return command;
}

PeaProtocol::PeaProtocol(const PeaPlan& plan) : plan_(plan), person_(plan.seed) {
  if (plan.cycles < 1 || !(plan.cycle_s > 0.5)) {
    throw std::invalid_argument("pea-data: cycles must be positive, longer than 0.5 s");
  }
  length_s_ = plan.cycle_s;
}

Command PeaProtocol::Step(const Reading& reading) noexcept {
  Command command;
  const double t = reading.time_s;
  if (cycle_ < plan_.cycles && t >= start_s_ + length_s_) {
    ++cycle_;
    start_s_ += length_s_;
    length_s_ = plan_.cycle_s * (1.0 + person_.Uniform(-0.15, 0.15));
    size_rad_ = std::numbers::pi * (1.0 - 0.04 * person_.Uniform(0.0, 1.0));
  }
  done_ = cycle_ >= plan_.cycles;
  command.drive = types::ControlMode::kTorque;
  command.motor_torque_Nm = plan_.motor_torque_Nm;
  if (done_) return command;
  // The hand waits at upright, goes down and back as a raised cosine, presses like a soft spring,
  // and cannot pull.
  const double hand_rad =
      0.5 * std::numbers::pi -
      0.5 * size_rad_ * (1.0 - std::cos(types::kTwoPi * std::max(0.0, t - start_s_) / length_s_));
  command.hand_force_N = std::clamp(plan_.hand_N_rad * (reading.output_angle_rad - hand_rad), 0.0,
                                    plan_.largest_hand_N);
  return command;
}

Recording TrimSea(const Recording& rows) {
  if (rows.size() < 100) throw std::invalid_argument("sea-data: fewer than 100 rows");
  const Span span = AngleSpan(rows);
  const std::vector<Cycle> cycles =
      FindCycles(rows, span.upper_rad, span.upper_rad - span.lower_rad);
  std::size_t end = rows.size();
  // The first of two pushes in a row after which the link stayed below.
  for (std::size_t i = 0; i + 1 < cycles.size(); ++i) {
    if (!cycles[i].came_back && !cycles[i + 1].came_back) {
      end = cycles[i].first;
      break;
    }
  }
  const std::size_t begin = cycles.empty() ? 0 : cycles.front().first;
  return {rows.begin() + static_cast<std::ptrdiff_t>(std::min(begin, end)),
          rows.begin() + static_cast<std::ptrdiff_t>(end)};
}

Result DescribeSea(const Recording& rows, const RigConstants& rig) {
  const Recording set = TrimSea(rows);
  const Span span = AngleSpan(rows);
  const double width_rad = span.upper_rad - span.lower_rad;
  const std::vector<Cycle> cycles = FindCycles(set, span.upper_rad, width_rad);
  if (cycles.size() < 3) {
    throw std::invalid_argument("sea-data: " + std::to_string(cycles.size()) +
                                " pushes, expected at least 3");
  }
  std::vector<double> rates_Hz, loss_J;
  const Cycle* at_4_bar = &cycles[1];
  for (std::size_t i = 1; i + 1 < cycles.size(); ++i) {
    const Cycle& c = cycles[i];
    rates_Hz.push_back(1.0 / (set[cycles[i + 1].first].time_s - set[c.first].time_s));
    if (std::abs(set[c.first].chamber_pressure_bar - 4.0) <
        std::abs(set[at_4_bar->first].chamber_pressure_bar - 4.0)) {
      at_4_bar = &c;
    }
    double work_J = 0.0;
    for (std::size_t k = c.first + 1; k <= c.last; ++k) {
      work_J -= 0.5 * (set[k].load_force_N + set[k - 1].load_force_N) * rig.link_length_m *
                (set[k].output_angle_rad - set[k - 1].output_angle_rad);
    }
    loss_J.push_back(work_J);
  }
  Result result{.experiment = "sea-data", .title = "Data inside the backlash (5.1.2)"};
  result.quantities = {
      Quantity{"pushes_Hz", "pushes a second", "Hz", MeanOfTrials(rates_Hz)}.Published(2.0,
                                                                                       "5.1.2"),
      Quantity{"recorded_s", "recorded", "s",
               Estimate{rows.back().time_s - rows.front().time_s, 0.0, 1}}
          .Published(100.0, "5.1.2")
          .WithoutInterval(),
      Quantity{"set_s", "set for networks", "s",
               Estimate{set.back().time_s - set.front().time_s, 0.0, 1},
               "until the chamber no longer brings the link back"}
          .WithoutInterval(),
      Quantity{"set_end_bar", "pressure where the set ends", "bar",
               Estimate{set.back().chamber_pressure_bar, 0.0, 1}}
          .Published(2.0, "Fig 5.9, about")
          .WithoutInterval(),
      Quantity{"cycle_loss_J", "energy lost in a push cycle", "J", MeanOfTrials(loss_J),
               "area of the loop of Fig 5.8: friction, and impacts of the teeth"}};
  report::Series loop;
  for (std::size_t i = at_4_bar->first; i <= at_4_bar->last; ++i) {
    loop.Add(set[i].output_angle_rad / types::kDegree_rad, set[i].load_force_N * rig.link_length_m);
  }
  result.figures = {
      TimeFigure(rows, "Pressure (Fig 5.5)", "pressure, bar",
                 [](const Row& r) { return r.chamber_pressure_bar; }),
      TimeFigure(rows, "Force on the link (Fig 5.5)", "force, N",
                 [](const Row& r) { return r.load_force_N; }),
      TimeFigure(rows, "Link angle (Fig 5.5)", "angle, degrees",
                 [](const Row& r) { return r.output_angle_rad / types::kDegree_rad; }),
      SpaceFigure(set, rig.link_length_m),
      report::Chart("One cycle near 4 bar (Fig 5.8)",
                    "Torque against angle: the area is what friction and impacts took.",
                    "angle, degrees", kFigure_px, {{"torque, N m", {std::move(loop)}}})};
  return result;
}

Result DescribePea(const Recording& rows, const RigConstants& rig) {
  if (rows.size() < 100) throw std::invalid_argument("pea-data: fewer than 100 rows");
  // Cycles: the link passes level going down.
  std::vector<double> start_s, lowest_deg;
  double lowest_rad = 10.0;
  bool below = false;
  for (const Row& row : rows) {
    const double q = row.output_angle_rad;
    if (!below && q < -0.5) {
      below = true;
      lowest_rad = q;
      start_s.push_back(row.time_s);
    }
    if (below) lowest_rad = std::min(lowest_rad, q);
    if (below && q > 0.5) {
      below = false;
      lowest_deg.push_back(lowest_rad / types::kDegree_rad);
    }
  }
  if (lowest_deg.size() < 2) {
    throw std::invalid_argument("pea-data: " + std::to_string(lowest_deg.size()) +
                                " cycles down and up, expected at least 2");
  }
  const Span span = AngleSpan(rows);
  double outside = 0.0;
  // Outside the backlash: the teeth touch. Seen as motor/N - link near its ends.
  std::vector<double> d;
  for (const Row& row : rows)
    d.push_back(row.motor_angle_rad / rig.gear_ratio - row.output_angle_rad);
  const double highest_d = identify::Quantile(d, 0.98);
  for (const double value : d) outside += value > highest_d - 0.002 ? 1.0 : 0.0;
  Result result{.experiment = "pea-data", .title = "Data outside the backlash (5.1.3)"};
  result.quantities = {
      Quantity{"cycles", "cycles down and up", "",
               Estimate{static_cast<double>(lowest_deg.size()), 0.0, 1}}
          .Published(100.0, "5.1.3")
          .WithoutInterval(),
      Quantity{"lowest_deg", "lowest angle of a cycle", "degrees", MeanOfTrials(lowest_deg)}
          .Published(-90.0, "5.1.3, hanging"),
      Quantity{"highest_deg", "highest angle", "degrees",
               Estimate{span.upper_rad / types::kDegree_rad, 0.0, 1}}
          .Published(90.0, "5.1.3, upright")
          .WithoutInterval(),
      Quantity{"outside_share", "rows with teeth in contact", "",
               Estimate{outside / static_cast<double>(rows.size()), 0.0, 1}}
          .WithoutInterval()};
  Recording first;
  for (const Row& row : rows) {
    if (row.time_s - rows.front().time_s < 35.0) first.push_back(row);
  }
  result.figures = {
      TimeFigure(first, "Link angle (Fig 5.10)", "angle, degrees",
                 [](const Row& r) { return r.output_angle_rad / types::kDegree_rad; }),
      TimeFigure(first, "Link velocity (Fig 5.10)", "velocity, rad/s",
                 [](const Row& r) { return r.output_velocity_rad_s; }),
      TimeFigure(first, "Pressure (Fig 5.10)", "pressure, bar",
                 [](const Row& r) { return r.chamber_pressure_bar; }),
      TimeFigure(first, "Force (Fig 5.10)", "force, N",
                 [](const Row& r) { return r.load_force_N; }),
      TimeFigure(first, "Motor current Iq (Fig 5.10)", "current, A",
                 [](const Row& r) { return r.motor_current_A; })};
  return result;
}

}  // namespace sinew::experiment
