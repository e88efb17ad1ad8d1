// Of push.h: moving friction and the pressure slope (5.4).
#include <Eigen/Core>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "components/model/experiment/push.h"
#include "components/model/experiment/statistics.h"

namespace sinew::experiment {

Result IdentifyMovingFriction(const Recording& rows, const RigConstants& rig) {
  const Play play = FindStrokes(rows);
  if (play.strokes.size() < 8) {
    throw std::invalid_argument("moving-friction: " + std::to_string(play.strokes.size()) +
                                " strokes through the play, expected at least 8");
  }
  std::vector<Eigen::Vector4d> x, z;
  std::vector<double> torque;
  std::vector<int> trial;
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
      x.insert(x.end(), {a, b});
      z.insert(z.end(), {b, a});
      torque.insert(torque.end(), 2, mean.force_N * rig.link_length_m);
      trial.insert(trial.end(), 2, number);
    }
    if (!windows.empty()) ++number;
  }
  Eigen::MatrixXd X(static_cast<Eigen::Index>(x.size()), 4), Z(X.rows(), 4);
  for (std::size_t i = 0; i < x.size(); ++i) {
    X.row(static_cast<Eigen::Index>(i)) = x[i];
    Z.row(static_cast<Eigen::Index>(i)) = z[i];
  }
  const TrialFit fit = FitTrials(
      X, Z, Eigen::Map<Eigen::VectorXd>(torque.data(), static_cast<Eigen::Index>(torque.size())),
      trial);

  // As published: strokes down, gravity from another experiment.
  const auto m = static_cast<Eigen::Index>(pressure.size());
  Result result{.experiment = "moving-friction",
                .title = "Moving friction and pressure slope (5.4)"};
  result.quantities = {{.id = "pressure_slope_Nm_bar",
                        .name = "K",
                        .unit = "Nm/bar",
                        .estimate = fit.At(0),
                        .published = 0.3587,
                        .source = "(5.4)",
                        .target_share = 0.02},
                       {.id = "moving_friction_Nm",
                        .name = "T_dyn",
                        .unit = "Nm",
                        .estimate = fit.At(1),
                        .published = 0.22,
                        .source = "(5.4)",
                        .target_share = 0.05,
                        .remark = "from strokes down and up"},
                       {.id = "gravity_moving_Nm",
                        .name = "gravity, link level",
                        .unit = "Nm",
                        .estimate = fit.At(2),
                        .published = 0.58,
                        .source = "(5.2)",
                        .target_share = 0.05}};
  Figure figure{.title = "Torque against pressure (Fig 5.6)",
                .caption =
                    "Mean torque of each stroke, with gravity; lines: (5.4), friction "
                    "against and with the hand.",
                .x_label = "pressure, bar",
                .y_label = "F l + gravity, N m",
                .series = {{.name = "down", .x = pressure, .y = torque_down},
                           {.name = "up", .x = pressure_up, .y = torque_up}}};
  for (const int side : {1, -1}) {
    Series line{.name = side > 0 ? "K P + T_dyn" : "K P - T_dyn", .line = true};
    for (double p = 2.0; p <= 6.01; p += 0.5) {
      line.x.push_back(p);
      line.y.push_back(fit.b(0) * p + side * fit.b(1) + rig.gravity_torque_Nm - fit.b(2));
    }
    figure.series.push_back(std::move(line));
  }
  if (m >= 4) {
    Eigen::MatrixXd D(m, 2);
    Eigen::VectorXd t(m);
    std::vector<int> down_trial;
    for (Eigen::Index i = 0; i < m; ++i) {
      D.row(i) << pressure[static_cast<std::size_t>(i)], 1.0;
      t(i) = torque_down[static_cast<std::size_t>(i)] +
             fit.b(3) * acceleration_down[static_cast<std::size_t>(i)];
      down_trial.push_back(static_cast<int>(i));
    }
    const TrialFit down = FitTrials(D, t, down_trial);
    result.quantities.push_back({.id = "pressure_slope_down_Nm_bar",
                                 .name = "K, strokes down only",
                                 .unit = "Nm/bar",
                                 .estimate = down.At(0),
                                 .published = 0.3587,
                                 .source = "(5.4)",
                                 .target_share = 0.02,
                                 .has_interval = false,
                                 .remark = "as published"});
    result.quantities.push_back({.id = "moving_friction_down_Nm",
                                 .name = "T_dyn, strokes down, gravity assumed",
                                 .unit = "Nm",
                                 .estimate = down.At(1),
                                 .published = 0.22,
                                 .source = "(5.4)",
                                 .has_interval = false,
                                 .remark = "as published; an error of the assumed gravity goes "
                                           "into it whole"});
  }
  result.figures.push_back(std::move(figure));
  return result;
}

}  // namespace sinew::experiment
