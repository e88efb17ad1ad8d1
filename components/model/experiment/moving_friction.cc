// Moving friction and the pressure slope (5.4), of push.h.
#include <Eigen/Core>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "components/model/experiment/push.h"
#include "components/model/experiment/statistics.h"

namespace sinew::experiment {

namespace {

// As published: strokes down, gravity from another experiment. fit: of all strokes.
void AddStrokesDown(const std::vector<double>& pressure, const std::vector<double>& torque_down,
                    const std::vector<double>& acceleration_down, const TrialFit& fit,
                    Result* result) {
  if (pressure.size() < 4) return;
  TrialRows of_strokes;
  for (std::size_t i = 0; i < pressure.size(); ++i) {
    of_strokes.Add(static_cast<int>(i), Eigen::Vector2d(pressure[i], 1.0),
                   torque_down[i] + fit.b(3) * acceleration_down[i]);
  }
  const TrialFit down = of_strokes.Fit();
  result->quantities.push_back(Quantity{"pressure_slope_down_Nm_bar", "K, strokes down only",
                                        "Nm/bar", down.At(0), "as published"}
                                   .Published(0.3587, "(5.4)")
                                   .WithinShare(0.02)
                                   .WithoutInterval());
  result->quantities.push_back(Quantity{"moving_friction_down_Nm",
                                        "T_dyn, strokes down, gravity assumed", "Nm", down.At(1),
                                        "as published; an error of the assumed gravity goes "
                                        "into it whole"}
                                   .Published(0.22, "(5.4)")
                                   .WithoutInterval());
}

}  // namespace

Result IdentifyMovingFriction(const Recording& rows, const RigConstants& rig) {
  const Play play = FindStrokes(rows);
  if (play.strokes.size() < 8) {
    throw std::invalid_argument("moving-friction: " + std::to_string(play.strokes.size()) +
                                " strokes through the play, expected at least 8");
  }
  TrialRows of_windows;
  std::vector<double> pressure, torque_down, acceleration_down, pressure_up, torque_up;
  int number = 0;
  for (const Stroke& s : play.strokes) {
    (s.direction < 0 ? pressure : pressure_up).push_back(s.mean.pressure_bar);
    if (s.direction < 0) acceleration_down.push_back(s.mean.acceleration_rad_s2());
    (s.direction < 0 ? torque_down : torque_up)
        .push_back(s.mean.force_N * rig.link_length_m + rig.gravity_torque_Nm * s.mean.cosine);
    const std::vector<Window> windows = WindowsOf(s);
    for (const auto& [first, last] : windows) {
      const WindowMean mean = HannMean(rows, first, last);
      // Twice, each half of the rows being the instrument of the other.
      const Eigen::Vector4d a(mean.pressure_bar, -s.direction, -mean.cosine,
                              -mean.acceleration_a_rad_s2);
      const Eigen::Vector4d b(a(0), a(1), a(2), -mean.acceleration_b_rad_s2);
      of_windows.Add(number, a, b, mean.force_N * rig.link_length_m);
      of_windows.Add(number, b, a, mean.force_N * rig.link_length_m);
    }
    if (!windows.empty()) ++number;
  }
  const TrialFit fit = of_windows.Fit();

  Result result{.experiment = "moving-friction",
                .title = "Moving friction and pressure slope (5.4)"};
  result.quantities = {
      Quantity{"pressure_slope_Nm_bar", "K", "Nm/bar", fit.At(0)}
          .Published(0.3587, "(5.4)")
          .WithinShare(0.02),
      Quantity{"moving_friction_Nm", "T_dyn", "Nm", fit.At(1), "from strokes down and up"}
          .Published(0.22, "(5.4)")
          .WithinShare(0.05),
      Quantity{"gravity_moving_Nm", "gravity, link level", "Nm", fit.At(2)}
          .Published(0.58, "(5.2)")
          .WithinShare(0.05)};
  std::vector<report::Series> series = {
      {.name = "down", .x = pressure, .y = torque_down, .style = kPoints},
      {.name = "up", .x = pressure_up, .y = torque_up, .style = kPoints}};
  for (const int side : {1, -1}) {
    report::Series line{.name = side > 0 ? "K P + T_dyn" : "K P - T_dyn"};
    for (double p = 2.0; p <= 6.01; p += 0.5) {
      line.Add(p, fit.b(0) * p + side * fit.b(1) + rig.gravity_torque_Nm - fit.b(2));
    }
    series.push_back(std::move(line));
  }
  AddStrokesDown(pressure, torque_down, acceleration_down, fit, &result);
  result.figures.push_back(report::Chart(
      "Torque against pressure (Fig 5.6)",
      "Mean torque of each stroke, with gravity; lines: (5.4), friction against and with the hand.",
      "pressure, bar", kFigure_px, {{"F l + gravity, N m", std::move(series)}}));
  return result;
}

}  // namespace sinew::experiment
