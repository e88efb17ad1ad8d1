#include "components/experiment/push.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "components/identify/statistics.h"
#include "components/types/angle.h"
#include "components/types/control_mode.h"

namespace sinew::experiment {
namespace {

constexpr double kMarginShare = 0.12;  // of the play, at each end
constexpr double kAtmosphere_bar = 1.013;
constexpr double kMovedSpeed_rad_s = 0.03;
constexpr double kBeyond_N = 2.0;  // past the force that moved the link: it stands at the end
constexpr double kLongestDown_s = 4.0;
constexpr double kLongestUp_s = 4.0;
constexpr int kFewestRows = 6;
constexpr double kReleased_N = 0.3;
constexpr double kRest_rad_s = 0.01;

}  // namespace

PushProtocol::PushProtocol(const PushPlan& plan) : plan_(plan) {
  if (!(plan.first_bar >= plan.last_bar) || !(plan.last_bar >= 0.0) || !(plan.duration_s > 0.0) ||
      plan.shut_every < 0 || !(plan.hand_N_rad > 0.0) || !(plan.hand_speed_rad_s > 0.0)) {
    throw std::invalid_argument(
        "pushes: pressures must fall, duration and the hand's numbers must be positive");
  }
}

Start PushProtocol::start() const {
  return {.pressure_bar = plan_.first_bar, .rest_s = 0.5, .rotor_locked = true};
}

Command PushProtocol::Step(const Reading& reading) noexcept {
  Command command;
  command.drive = types::ControlMode::kPosition;  // holds the motor
  if (reading.time_s >= plan_.duration_s) {
    done_ = true;
    return command;
  }
  const double dt_s = reading.time_s - last_s_;
  last_s_ = reading.time_s;
  const double angle_rad = reading.output_angle_rad;
  const double velocity_rad_s = reading.output_velocity_rad_s;
  const double in_phase_s = reading.time_s - phase_s_;
  double hand_speed_rad_s = 0.0;
  switch (phase_) {
    case Phase::kPause:
      hand_rad_ = angle_rad;
      if (in_phase_s > plan_.pause_s) {
        phase_ = Phase::kDown;
        phase_s_ = reading.time_s;
        moving_force_N_ = 0.0;
        moved_s_ = 0.0;
        start_rad_ = angle_rad;
        ++pushes_;
      }
      break;
    case Phase::kDown: {
      hand_speed_rad_s = -plan_.hand_speed_rad_s;
      if (velocity_rad_s < -kMovedSpeed_rad_s) {
        moving_force_N_ += (reading.load_force_N - moving_force_N_) * (moved_s_ > 0.0 ? 0.1 : 1.0);
        moved_s_ = reading.time_s;
      }
      const bool ended = moved_s_ > 0.0 && reading.time_s - moved_s_ > 0.1 &&
                         reading.load_force_N > moving_force_N_ + kBeyond_N;
      if (ended || reading.load_force_N > plan_.largest_hand_N - 0.5 ||
          in_phase_s > kLongestDown_s) {
        phase_ = Phase::kUp;
        phase_s_ = reading.time_s;
      }
      break;
    }
    case Phase::kUp:
      hand_speed_rad_s = plan_.hand_speed_rad_s;
      if ((plan_.hand_N_rad * (angle_rad - hand_rad_) < -0.5 &&
           std::abs(velocity_rad_s) < kMovedSpeed_rad_s) ||
          in_phase_s > kLongestUp_s) {
        phase_ = Phase::kPause;
        phase_s_ = reading.time_s;
      }
      break;
  }
  if (phase_ != Phase::kPause) {
    hand_rad_ += hand_speed_rad_s * dt_s;
    command.hand_force_N = std::clamp(plan_.hand_N_rad * (angle_rad - hand_rad_) +
                                          plan_.hand_N_s_rad * (velocity_rad_s - hand_speed_rad_s),
                                      0.0, plan_.largest_hand_N);
  }
  const double planned_bar =
      plan_.first_bar - (plan_.first_bar - plan_.last_bar) * reading.time_s / plan_.duration_s;
  command.vent_open = reading.reservoir_pressure_bar > planned_bar;
  command.valve_open =
      plan_.shut_every == 0 || phase_ == Phase::kPause || pushes_ % plan_.shut_every != 0;
  return command;
}

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
  // zone: +1 above top, -1 below bottom, 0 between. A stroke leads from one to the other.
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
      play.strokes.push_back({.direction = zone,
                              .first = left + 1,
                              .last = i - 1,
                              .start_s = rows[left + 1].time_s,
                              .valve_open = rows[i - 1].valve_open,
                              .mean = HannMean(rows, left + 1, i - 1)});
    }
    from = zone;
    left = i;
  }
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
  const auto mean_of = [&rows](const std::vector<std::size_t>& in, double* variance_rad2) {
    std::vector<double> angles_rad;
    for (const std::size_t i : in) angles_rad.push_back(rows[i].output_angle_rad);
    *variance_rad2 = std::pow(identify::StandardDeviation(angles_rad), 2);
    return identify::Mean(angles_rad);
  };
  if (!play.upper_rows.empty()) play.upper_rad = mean_of(play.upper_rows, &play.upper_rad2);
  if (!play.lower_rows.empty()) play.lower_rad = mean_of(play.lower_rows, &play.lower_rad2);
  // Pushes: the force rises above 1 N and falls below 0.3 N again.
  bool pushing = false;
  for (const Row& row : rows) {
    if (!pushing && row.load_force_N > 1.0) {
      pushing = true;
      play.pushes.push_back({.start_s = row.time_s,
                             .pressure_bar = row.chamber_pressure_bar,
                             .valve_open = row.valve_open});
    }
    if (row.load_force_N < kReleased_N) pushing = false;
  }
  for (std::size_t i = 0; i < play.pushes.size(); ++i) {
    Play::Push& push = play.pushes[i];
    const double next_s = i + 1 < play.pushes.size() ? play.pushes[i + 1].start_s : 1e18;
    for (const Stroke& stroke : play.strokes) {
      if (stroke.direction > 0 || stroke.start_s < push.start_s - 0.3 ||
          stroke.start_s >= next_s - 0.3) {
        continue;
      }
      push.passed = true;
      push.mean = stroke.mean;
      push.pressure_bar = stroke.mean.pressure_bar;
    }
  }
  return play;
}

namespace {

constexpr int kWindows = 4;

// Half-overlapping windows of a stroke; none where it is too short.
struct Window {
  std::size_t first = 0, last = 0;
};
std::vector<Window> WindowsOf(const Stroke& stroke) {
  std::vector<Window> windows;
  const std::size_t n = stroke.last - stroke.first + 1;
  if (n < 4 * kFewestRows) return windows;
  const std::size_t length = 2 * n / (kWindows + 1);
  for (int k = 0; k < kWindows; ++k) {
    const std::size_t first =
        stroke.first + static_cast<std::size_t>(k) * (n - length) / (kWindows - 1);
    windows.push_back({first, std::min(first + length, stroke.last)});
  }
  return windows;
}

// Windows inside the strokes, each stroke's own level taken away: X = angle (scaled to 6 bar),
// acceleration, time. Every window twice: the acceleration of one half of its rows is the
// instrument for that of the other.
struct SlopeRows {
  Eigen::MatrixXd X, Z;
  Eigen::VectorXd y;
  std::vector<int> stroke;
};
SlopeRows MakeSlopeRows(const Recording& rows, const Play& play, bool valve_open, double length_m) {
  using Vector5 = Eigen::Matrix<double, 5, 1>;
  std::vector<Vector5> all;  // angle, acceleration of both halves, time, torque
  SlopeRows result;
  int number = 0;
  for (const Stroke& stroke : play.strokes) {
    const std::vector<Window> windows = WindowsOf(stroke);
    if (stroke.valve_open != valve_open || windows.empty()) continue;
    Vector5 level = Vector5::Zero();
    std::vector<Vector5> here;
    for (const auto& [first, last] : windows) {
      const WindowMean mean = HannMean(rows, first, last);
      here.push_back({mean.angle_rad, mean.acceleration_a_rad_s2, mean.acceleration_b_rad_s2,
                      mean.time_s, mean.force_N * length_m});
      level += here.back() / kWindows;
    }
    const double scale = (stroke.mean.pressure_bar + kAtmosphere_bar) / (6.0 + kAtmosphere_bar);
    for (Vector5& row : here) {
      row -= level;
      row(0) *= scale;
      all.push_back(row);
      result.stroke.insert(result.stroke.end(), 2, number);
    }
    ++number;
  }
  const auto windows_n = static_cast<Eigen::Index>(all.size());
  result.X.resize(2 * windows_n, 3);
  result.Z.resize(2 * windows_n, 3);
  result.y.resize(2 * windows_n);
  for (Eigen::Index i = 0; i < windows_n; ++i) {
    const Vector5& row = all[static_cast<std::size_t>(i)];
    const Eigen::RowVector3d a(row(0), row(1), row(3)), b(row(0), row(2), row(3));
    result.X.row(2 * i) = result.Z.row(2 * i + 1) = a;
    result.Z.row(2 * i) = result.X.row(2 * i + 1) = b;
    result.y(2 * i) = result.y(2 * i + 1) = row(4);
  }
  return result;
}

}  // namespace

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

double MeanSlope(const Recording& rows, const Play& play, bool valve_open, double length_m) {
  const SlopeRows slope = MakeSlopeRows(rows, play, valve_open, length_m);
  return -FitTrials(slope.X, slope.Z, slope.y, slope.stroke).b(0);
}

Result IdentifyStiffness(const Recording& rows, const RigConstants& rig) {
  const Play play = FindStrokes(rows);
  const double width_rad = play.upper_rad - play.lower_rad;
  Result result{.experiment = "stiffness", .title = "Stiffness (5.5)"};
  // Secant of each push.
  std::vector<double> pressure, secant, acceleration, none_pressure, none;
  for (const Play::Push& push : play.pushes) {
    if (push.passed) {
      if (!push.valve_open) continue;
      pressure.push_back(push.pressure_bar);
      secant.push_back(push.mean.force_N * rig.link_length_m / width_rad);
      acceleration.push_back(push.mean.acceleration_rad_s2());
    } else {
      none_pressure.push_back(push.pressure_bar);
      none.push_back(0.0);
    }
  }
  const auto n = static_cast<Eigen::Index>(pressure.size());
  if (n < 6) {
    throw std::invalid_argument("stiffness: " + std::to_string(n) +
                                " pushes through the play, expected at least 6");
  }
  Eigen::MatrixXd X(n, 3);
  Eigen::VectorXd y(n);
  std::vector<int> trial;
  for (Eigen::Index i = 0; i < n; ++i) {
    X.row(i) << 1.0, pressure[static_cast<std::size_t>(i)],
        acceleration[static_cast<std::size_t>(i)];
    y(i) = secant[static_cast<std::size_t>(i)];
    trial.push_back(static_cast<int>(i));
  }
  const TrialFit fit = FitTrials(X, y, trial);
  // The way through the play is the same number in every push: its error, from the rounding of the
  // encoder at two contacts, does not average out.
  const double count_rad = types::kTwoPi / rig.encoder_counts;
  constexpr double kNormal = 1.96;
  const double rounding_share = kNormal *
                                std::hypot(LargestRounding(play.upper_rad2, count_rad),
                                           LargestRounding(play.lower_rad2, count_rad)) /
                                (std::numbers::sqrt2 * width_rad);
  const auto with_rounding = [rounding_share](Estimate estimate) {
    estimate.half_width_95 =
        std::hypot(estimate.half_width_95, rounding_share * std::abs(estimate.value));
    return estimate;
  };
  result.quantities.push_back(
      {.id = "secant_6bar_Nm_rad",
       .name = "secant of a push cycle at 6 bar",
       .unit = "Nm/rad",
       .estimate = with_rounding(fit.Of(fit.b(0) + 6.0 * fit.b(1), Eigen::Vector3d(1.0, 6.0, 0.0))),
       .published = 100.0,
       .source = "Fig 5.9",
       .remark = "100 over 2.66 degrees is 4.6 Nm, K x 6 bar is 2.15: both cannot hold"});
  result.quantities.push_back({.id = "secant_slope_Nm_rad_bar",
                               .name = "secant per bar",
                               .unit = "Nm/rad/bar",
                               .estimate = with_rounding(fit.At(1))});

  // Where the chamber no longer brings the link back: the force of the way up, extrapolated to 0.
  std::vector<Stroke> up;
  for (const Stroke& stroke : play.strokes) {
    if (stroke.direction > 0 && stroke.valve_open) up.push_back(stroke);
  }
  if (up.size() >= 6) {
    const auto m = static_cast<Eigen::Index>(up.size());
    Eigen::MatrixXd U(m, 3);
    Eigen::VectorXd f(m);
    std::vector<int> up_trial;
    for (Eigen::Index i = 0; i < m; ++i) {
      const Stroke& s = up[static_cast<std::size_t>(i)];
      U.row(i) << 1.0, s.mean.pressure_bar, -s.mean.acceleration_rad_s2();
      f(i) = s.mean.force_N * rig.link_length_m;
      up_trial.push_back(static_cast<int>(i));
    }
    const TrialFit back = FitTrials(U, f, up_trial);
    const double zero_bar = -back.b(0) / back.b(1);
    result.quantities.push_back(
        {.id = "return_limit_bar",
         .name = "pressure under which friction wins",
         .unit = "bar",
         .estimate = back.Of(zero_bar, Eigen::Vector3d(-1.0, -zero_bar, 0.0) / back.b(1)),
         .published = 2.0,
         .source = "Fig 5.9, about"});
    double lowest_passed = 1e9, highest_stuck = -1.0;
    for (const double p : pressure) lowest_passed = std::min(lowest_passed, p);
    for (const double p : none_pressure) highest_stuck = std::max(highest_stuck, p);
    char text[160];
    if (highest_stuck >= 0.0) {
      std::snprintf(text, sizeof text,
                    "The link last came back at %.2f bar; from %.2f bar down the secant is 0.",
                    lowest_passed, highest_stuck);
      result.remarks.emplace_back(text);
    }
  }

  // Differential stiffness of the gas, scaled to 6 bar by absolute pressure: -d(torque)/dq.
  for (const bool open : {false, true}) {
    const SlopeRows slope = MakeSlopeRows(rows, play, open, rig.link_length_m);
    if (slope.stroke.empty() || slope.stroke.back() < 6) continue;
    TrialFit gas = FitTrials(slope.X, slope.Z, slope.y, slope.stroke);
    gas.b(0) = -gas.b(0);
    result.quantities.push_back({.id = open ? "gas_open_Nm_rad" : "gas_shut_Nm_rad",
                                 .name = open ? "gas stiffness, reservoir joined, at 6 bar"
                                              : "gas stiffness, chamber shut, at 6 bar",
                                 .unit = "Nm/rad",
                                 .estimate = gas.At(0)});
  }

  Figure figure{.title = "Stiffness against pressure (Fig 5.9)",
                .caption =
                    "Secant of each push: torque that takes the link through the play over "
                    "the play; 0 where the link had not come back.",
                .x_label = "pressure, bar",
                .y_label = "secant stiffness, N m/rad",
                .series = {{.name = "pushes", .x = pressure, .y = secant},
                           {.name = "did not come back", .x = none_pressure, .y = none}}};
  Series line{.name = "fit", .line = true};
  for (double p = 2.2; p <= 6.01; p += 0.2) {
    line.x.push_back(p);
    line.y.push_back(fit.b(0) + fit.b(1) * p);
  }
  figure.series.push_back(std::move(line));
  result.figures.push_back(std::move(figure));
  return result;
}

}  // namespace sinew::experiment
