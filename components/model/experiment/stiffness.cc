// Secant of a push and stiffness of the gas (5.5), of push.h.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "components/base/types/angle.h"
#include "components/model/experiment/push.h"
#include "components/model/experiment/statistics.h"

namespace sinew::experiment {
namespace {

constexpr double kAtmosphere_bar = 1.013;

// Windows inside the strokes, each stroke's own level taken away: X = angle (scaled to 6 bar),
// acceleration, time. Every window twice: the acceleration of one half of its rows is the
// instrument for that of the other.
TrialRows MakeSlopeRows(const Recording& rows, const Play& play, bool valve_open, double length_m) {
  using Vector5 = Eigen::Matrix<double, 5, 1>;
  TrialRows result;
  int number = 0;
  for (const Stroke& stroke : play.strokes) {
    const std::vector<Window> windows = WindowsOf(stroke);
    if (stroke.valve_open != valve_open || windows.empty()) continue;
    Vector5 level = Vector5::Zero();
    std::vector<Vector5> here;  // angle, acceleration of both halves, time, torque
    for (const auto& [first, last] : windows) {
      const WindowMean mean = HannMean(rows, first, last);
      here.push_back({mean.angle_rad, mean.acceleration_a_rad_s2, mean.acceleration_b_rad_s2,
                      mean.time_s, mean.force_N * length_m});
      level += here.back() / kStrokeWindows;
    }
    const double scale = (stroke.mean.pressure_bar + kAtmosphere_bar) / (6.0 + kAtmosphere_bar);
    for (Vector5& row : here) {
      row -= level;
      row(0) *= scale;
      const Eigen::Vector3d a(row(0), row(1), row(3)), b(row(0), row(2), row(3));
      result.Add(number, a, b, row(4));
      result.Add(number, b, a, row(4));
    }
    ++number;
  }
  return result;
}

// Adds the pressure that no longer brings the link back: the force of the way up, extrapolated to
// 0. passed, stuck: pressures of the pushes after which the link came back, and did not.
void AddReturnLimit(const Play& play, const std::vector<double>& passed,
                    const std::vector<double>& stuck, const RigConstants& rig, Result* result) {
  TrialRows up;
  for (const Stroke& s : play.strokes) {
    if (s.direction <= 0 || !s.valve_open) continue;
    up.Add(static_cast<int>(up.size()),
           Eigen::Vector3d(1.0, s.mean.pressure_bar, -s.mean.acceleration_rad_s2()),
           s.mean.force_N * rig.link_length_m);
  }
  if (up.size() < 6) return;
  const TrialFit back = up.Fit();
  const double zero_bar = -back.b(0) / back.b(1);
  result->quantities.push_back(
      Quantity{"return_limit_bar", "pressure under which friction wins", "bar",
               back.Of(zero_bar, Eigen::Vector3d(-1.0, -zero_bar, 0.0) / back.b(1))}
          .Published(2.0, "Fig 5.9, about"));
  if (stuck.empty()) return;
  result->remarks.push_back(
      report::Text("The link last came back at %.2f bar; from %.2f bar down the secant is 0.",
                   *std::min_element(passed.begin(), passed.end()),
                   *std::max_element(stuck.begin(), stuck.end())));
}

// The way through the play is the same number in every push: its error, from the rounding of the
// encoder at two contacts, does not average out. Share of the way, 95 %.
double RoundingShare(const Play& play, const RigConstants& rig) {
  const double count_rad = types::kTwoPi / rig.encoder_counts;
  constexpr double kNormal = 1.96;
  return kNormal *
         std::hypot(LargestRounding(play.upper_rad2, count_rad),
                    LargestRounding(play.lower_rad2, count_rad)) /
         (std::numbers::sqrt2 * (play.upper_rad - play.lower_rad));
}

}  // namespace

double MeanSlope(const Recording& rows, const Play& play, bool valve_open, double length_m) {
  return -MakeSlopeRows(rows, play, valve_open, length_m).Fit().b(0);
}

Result IdentifyStiffness(const Recording& rows, const RigConstants& rig) {
  const Play play = FindStrokes(rows);
  const double width_rad = play.upper_rad - play.lower_rad;
  Result result{.experiment = "stiffness", .title = "Stiffness (5.5)"};
  // Secant of each push.
  std::vector<double> pressure, secant, none_pressure, none;
  TrialRows rows_of_pushes;
  for (const Play::Push& push : play.pushes) {
    if (push.passed) {
      if (!push.valve_open) continue;
      pressure.push_back(push.pressure_bar);
      secant.push_back(push.mean.force_N * rig.link_length_m / width_rad);
      rows_of_pushes.Add(static_cast<int>(rows_of_pushes.size()),
                         Eigen::Vector3d(1.0, push.pressure_bar, push.mean.acceleration_rad_s2()),
                         secant.back());
    } else {
      none_pressure.push_back(push.pressure_bar);
      none.push_back(0.0);
    }
  }
  if (pressure.size() < 6) {
    throw std::invalid_argument("stiffness: " + std::to_string(pressure.size()) +
                                " pushes through the play, expected at least 6");
  }
  const TrialFit fit = rows_of_pushes.Fit();
  const double rounding_share = RoundingShare(play, rig);
  const auto with_rounding = [rounding_share](Estimate estimate) {
    estimate.half_width_95 =
        std::hypot(estimate.half_width_95, rounding_share * std::abs(estimate.value));
    return estimate;
  };
  result.quantities.push_back(
      Quantity{"secant_6bar_Nm_rad", "secant of a push cycle at 6 bar", "Nm/rad",
               with_rounding(fit.Of(fit.b(0) + 6.0 * fit.b(1), Eigen::Vector3d(1.0, 6.0, 0.0))),
               "100 over 2.66 degrees is 4.6 Nm, K x 6 bar is 2.15: both cannot hold"}
          .Published(100.0, "Fig 5.9"));
  result.quantities.push_back(Quantity{"secant_slope_Nm_rad_bar", "secant per bar", "Nm/rad/bar",
                                       with_rounding(fit.At(1))});

  AddReturnLimit(play, pressure, none_pressure, rig, &result);

  // Differential stiffness of the gas, scaled to 6 bar by absolute pressure: -d(torque)/dq.
  for (const bool open : {false, true}) {
    const TrialRows slope = MakeSlopeRows(rows, play, open, rig.link_length_m);
    if (slope.trials() < 7) continue;
    TrialFit gas = slope.Fit();
    gas.b(0) = -gas.b(0);
    result.quantities.push_back(Quantity{open ? "gas_open_Nm_rad" : "gas_shut_Nm_rad",
                                         open ? "gas stiffness, reservoir joined, at 6 bar"
                                              : "gas stiffness, chamber shut, at 6 bar",
                                         "Nm/rad", gas.At(0)});
  }

  report::Series line{.name = "fit"};
  for (double p = 2.2; p <= 6.01; p += 0.2) {
    line.Add(p, fit.b(0) + fit.b(1) * p);
  }
  result.figures.push_back(report::Chart(
      "Stiffness against pressure (Fig 5.9)",
      "Secant of each push: torque that takes the link through the play over the play; 0 where the "
      "link had not come back.",
      "pressure, bar", kFigure_px,
      {{"secant stiffness, N m/rad",
        {{.name = "pushes", .x = pressure, .y = secant, .style = kPoints},
         {.name = "did not come back", .x = none_pressure, .y = none, .style = kPoints},
         std::move(line)}}}));
  return result;
}

}  // namespace sinew::experiment
