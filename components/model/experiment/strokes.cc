#include "components/model/experiment/strokes.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "components/base/types/angle.h"
#include "components/model/identify/statistics.h"

namespace sinew::experiment {
namespace {

constexpr double kMarginShare = 0.12;  // of the play, at each end
constexpr std::size_t kFewestRows = 6;
constexpr double kReleased_N = 0.3;
constexpr double kRest_rad_s = 0.01;

// Ways from below the bottom to above the top, or back.
std::vector<Stroke> StrokesBetween(const Recording& rows, double bottom_rad, double top_rad) {
  std::vector<Stroke> strokes;
  int from = 0;
  std::size_t left = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double q = rows[i].output_angle_rad;
    const int zone = q > top_rad ? 1 : q < bottom_rad ? -1 : 0;
    if (zone == 0) continue;
    bool moving = from != 0 && zone == -from && i > left + kFewestRows;
    for (std::size_t k = left + 1; moving && k < i; ++k) {
      moving = zone * rows[k].output_velocity_rad_s > kMovedSpeed_rad_s;
    }
    if (moving) {
      strokes.push_back({.direction = zone,
                         .first = left + 1,
                         .last = i - 1,
                         .start_s = rows[left + 1].time_s,
                         .valve_open = rows[i - 1].valve_open,
                         .mean = HannMean(rows, left + 1, i - 1)});
    }
    from = zone;
    left = i;
  }
  return strokes;
}

// The force rises above 1 N and falls below 0.3 N again.
void FindPushes(const Recording& rows, Play* play) {
  bool pushing = false;
  for (const Row& row : rows) {
    if (!pushing && row.load_force_N > 1.0) {
      pushing = true;
      play->pushes.push_back({.start_s = row.time_s,
                              .pressure_bar = row.chamber_pressure_bar,
                              .valve_open = row.valve_open});
    }
    if (row.load_force_N < kReleased_N) pushing = false;
  }
  double end_s = 1e18;
  for (auto push = play->pushes.rbegin(); push != play->pushes.rend(); ++push) {
    for (const Stroke& stroke : play->strokes) {
      const bool within = stroke.start_s >= push->start_s - 0.3 && stroke.start_s < end_s;
      if (stroke.direction > 0 || !within) continue;
      push->passed = true;
      push->mean = stroke.mean;
      push->pressure_bar = stroke.mean.pressure_bar;
    }
    end_s = push->start_s - 0.3;
  }
}

}  // namespace

WindowMean HannMean(const Recording& rows, std::size_t first, std::size_t last) {
  WindowMean mean{.cosine = 0.0};
  const double start_s = rows[first].time_s, length_s = rows[last].time_s - start_s;
  double sum = 0.0;
  for (std::size_t k = first; k <= last; ++k) {
    const Row& row = rows[k];
    const double before_s = k > first ? rows[k - 1].time_s : row.time_s;
    const double after_s = k < last ? rows[k + 1].time_s : row.time_s;
    const double step_s = 0.5 * (after_s - before_s);
    const double weight =
        (1.0 - std::cos(types::kTwoPi * (row.time_s - start_s) / length_s)) * step_s;
    sum += weight;
    mean.time_s += weight * row.time_s;
    mean.force_N += weight * row.load_force_N;
    mean.pressure_bar += weight * row.chamber_pressure_bar;
    mean.cosine += weight * std::cos(row.output_angle_rad);
    mean.angle_rad += weight * row.output_angle_rad;
  }
  mean.time_s /= sum;
  mean.force_N /= sum;
  mean.pressure_bar /= sum;
  mean.cosine /= sum;
  mean.angle_rad /= sum;
  // A straight line has no acceleration, and its integral with d2w/dt2 is 0: what is left after the
  // chord is small, and so is the error of summing it.
  const double chord_rad_s =
      (rows[last].output_angle_rad - rows[first].output_angle_rad) / length_s;
  const double bend_1_s2 = std::pow(types::kTwoPi / length_s, 2) / length_s;
  for (const std::size_t half : {0u, 1u}) {
    double sum_rad_s2 = 0.0;
    for (std::size_t k = first + 1 + half; k < last; k += 2) {
      const std::size_t before = k >= first + 2 ? k - 2 : first, after = std::min(k + 2, last);
      const double step_s = 0.5 * (rows[after].time_s - rows[before].time_s);
      const double in_s = rows[k].time_s - start_s;
      sum_rad_s2 += bend_1_s2 * std::cos(types::kTwoPi * in_s / length_s) * step_s *
                    (rows[k].output_angle_rad - rows[first].output_angle_rad - chord_rad_s * in_s);
    }
    (half == 0 ? mean.acceleration_a_rad_s2 : mean.acceleration_b_rad_s2) = sum_rad_s2;
  }
  return mean;
}

Play FindStrokes(const Recording& rows) {
  if (rows.size() < 50) {
    throw std::invalid_argument("pushes: " + std::to_string(rows.size()) +
                                " rows, expected a recording of pushes");
  }
  std::vector<double> angles;
  for (const Row& row : rows) angles.push_back(row.output_angle_rad);
  Play play;
  play.lower_rad = identify::Quantile(angles, 0.03);
  play.upper_rad = identify::Quantile(angles, 0.97);
  const double width_rad = play.upper_rad - play.lower_rad;
  if (width_rad < 0.005) {
    throw std::invalid_argument("pushes: the link moved by " +
                                std::to_string(width_rad / types::kDegree_rad) +
                                " degrees, expected it to pass the play");
  }
  const double top_rad = play.upper_rad - kMarginShare * width_rad;
  const double bottom_rad = play.lower_rad + kMarginShare * width_rad;
  play.strokes = StrokesBetween(rows, bottom_rad, top_rad);
  // The contacts, from counts of the encoder averaged over rows in which the link surely rests on
  // them: let go above; below, pressed harder than what brought it there.
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].output_angle_rad > top_rad && rows[i].load_force_N < kReleased_N) {
      play.upper_rows.push_back(i);
    }
  }
  for (const Stroke& stroke : play.strokes) {
    if (stroke.direction > 0) continue;
    for (std::size_t i = stroke.last + 1; i < rows.size(); ++i) {
      const Row& row = rows[i];
      if (row.output_angle_rad > bottom_rad) break;
      if (std::abs(row.output_velocity_rad_s) > kRest_rad_s) continue;
      if (row.load_force_N < stroke.mean.force_N + 0.2) break;
      play.lower_rows.push_back(i);
    }
  }
  for (const bool upper : {true, false}) {
    std::vector<double> angles_rad;
    for (const std::size_t i : upper ? play.upper_rows : play.lower_rows) {
      angles_rad.push_back(rows[i].output_angle_rad);
    }
    if (angles_rad.empty()) continue;
    (upper ? play.upper_rad : play.lower_rad) = identify::Mean(angles_rad);
    (upper ? play.upper_rad2 : play.lower_rad2) =
        std::pow(identify::StandardDeviation(angles_rad), 2);
  }
  FindPushes(rows, &play);
  return play;
}

std::vector<Window> WindowsOf(const Stroke& stroke) {
  std::vector<Window> windows;
  const std::size_t n = stroke.last - stroke.first + 1;
  if (n < 4 * kFewestRows) return windows;
  const std::size_t length = 2 * n / (kStrokeWindows + 1);
  for (int k = 0; k < kStrokeWindows; ++k) {
    const std::size_t first =
        stroke.first + static_cast<std::size_t>(k) * (n - length) / (kStrokeWindows - 1);
    windows.push_back({first, std::min(first + length, stroke.last)});
  }
  return windows;
}

}  // namespace sinew::experiment
