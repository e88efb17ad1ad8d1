#include "components/model/experiment/breakaway.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "components/base/types/angle.h"
#include "components/base/types/control_mode.h"
#include "components/base/types/text.h"
#include "components/model/identify/statistics.h"

namespace sinew::experiment {
namespace {

constexpr double kLargestPress_N = 20.0;
constexpr double kGone_rad = 0.012;  // the link has given way
constexpr double kAfter_s = 0.3;     // the hand lets go
constexpr double kLiftSpeed_rad_s = 0.5;
constexpr double kBackOff_s = 0.6;
constexpr double kLongestPush_s = 20.0;
constexpr double kCatch_s = 0.5;
constexpr double kFitFrom_s = 0.2, kFitTo_s = 0.02, kRead_s = 0.06;  // before the link is gone

// The moving end of a soft hand, and the force it presses with.
double HandForce_N(double stiffness_N_rad, double link_rad, double hand_rad) {
  return std::clamp(stiffness_N_rad * (link_rad - hand_rad), 0.0, kLargestPress_N);
}

// The value at a time of the parabola fitted to the points.
double ParabolaAt(const std::vector<double>& time_s, const std::vector<double>& force_N,
                  double at_s) {
  const auto n = static_cast<Eigen::Index>(time_s.size());
  Eigen::MatrixXd X(n, 3);
  for (Eigen::Index k = 0; k < n; ++k) {
    const double t = time_s[static_cast<std::size_t>(k)] - at_s;
    X.row(k) << 1.0, t, t * t;
  }
  return X.colPivHouseholderQr().solve(Eigen::Map<const Eigen::VectorXd>(force_N.data(), n))(0);
}

}  // namespace

BreakawayProtocol::BreakawayProtocol(const BreakawayPlan& plan) : plan_(plan) {
  if (!(plan.rate_N_s > 0.0) || !(plan.hand_N_rad > 0.0) || !(plan.rest_s >= 0.0)) {
    throw std::invalid_argument("breakaway: rate and hand must be positive, rest not negative");
  }
}

Command BreakawayProtocol::Step(const Reading& reading) noexcept {
  Command command;  // the motor idles inside the play
  if (first_) {
    rest_angle_rad_ = hand_rad_ = reading.output_angle_rad;
    last_s_ = reading.time_s;
    first_ = false;
  }
  const double dt_s = reading.time_s - last_s_;
  last_s_ = reading.time_s;
  if (broken_s_ < 0.0 && rest_angle_rad_ - reading.output_angle_rad > kGone_rad) {
    broken_s_ = reading.time_s;
  }
  done_ = (broken_s_ >= 0.0 && reading.time_s > broken_s_ + kAfter_s) ||
          reading.time_s > plan_.longest_s;
  hand_rad_ -= plan_.rate_N_s / plan_.hand_N_rad * dt_s;
  command.hand_force_N =
      broken_s_ >= 0.0 ? 0.0 : HandForce_N(plan_.hand_N_rad, reading.output_angle_rad, hand_rad_);
  return command;
}

BreakawayTour::BreakawayTour(std::vector<double> angles_rad, const BreakawayPlan& plan,
                             double gear_ratio)
    : angles_rad_(std::move(angles_rad)), plan_(plan), gear_ratio_(gear_ratio) {
  if (angles_rad_.empty()) throw std::invalid_argument("breakaway: no angles");
  // Always lifted: the teeth then carry the link from below.
  std::sort(angles_rad_.begin(), angles_rad_.end());
}

void BreakawayTour::Enter(Phase phase, double time_s) noexcept {
  phase_ = phase;
  phase_s_ = time_s;
}

Command BreakawayTour::Step(const Reading& reading) noexcept {
  Command command;
  command.drive = types::ControlMode::kPosition;
  command.vent_open = true;
  if (first_) {
    wanted_rad_ = reading.motor_angle_rad / gear_ratio_;
    last_s_ = phase_s_ = reading.time_s;
    first_ = false;
  }
  const double dt_s = reading.time_s - last_s_;
  last_s_ = reading.time_s;
  const double in_phase_s = reading.time_s - phase_s_;
  if (!done()) {
    const double half_play_rad = 0.5 * plan_.play_rad;
    switch (phase_) {
      case Phase::kLift: {
        const double target_rad = angles_rad_[next_] + half_play_rad;
        const double step_rad = kLiftSpeed_rad_s * dt_s;
        wanted_rad_ += std::clamp(target_rad - wanted_rad_, -step_rad, step_rad);
        if (std::abs(target_rad - wanted_rad_) < 1e-9) Enter(Phase::kSettle, reading.time_s);
        break;
      }
      case Phase::kSettle:
        if (in_phase_s >= 0.5 * plan_.rest_s) {
          held_rad_ = reading.output_angle_rad;
          Enter(Phase::kBackOff, reading.time_s);
        }
        break;
      case Phase::kBackOff: {
        const double step_rad = half_play_rad / (0.5 * kBackOff_s) * dt_s;
        wanted_rad_ += std::clamp(held_rad_ - wanted_rad_, -step_rad, step_rad);
        if (in_phase_s >= kBackOff_s) Enter(Phase::kRest, reading.time_s);
        break;
      }
      case Phase::kRest:
        if (in_phase_s >= plan_.rest_s) {
          held_rad_ = hand_rad_ = reading.output_angle_rad;
          Enter(Phase::kPush, reading.time_s);
        }
        break;
      case Phase::kPush:
        hand_rad_ -= plan_.rate_N_s / plan_.hand_N_rad * dt_s;
        command.hand_force_N = HandForce_N(plan_.hand_N_rad, reading.output_angle_rad, hand_rad_);
        if (held_rad_ - reading.output_angle_rad > kGone_rad || in_phase_s > kLongestPush_s) {
          command.hand_force_N = 0.0;
          Enter(Phase::kCatch, reading.time_s);
        }
        break;
      case Phase::kCatch:
        if (in_phase_s >= kCatch_s) {
          ++next_;
          Enter(Phase::kLift, reading.time_s);
        }
        break;
    }
  }
  command.position_rad = wanted_rad_;
  return command;
}

std::vector<Breakaway> FindBreakaways(const Recording& rows) {
  std::vector<Breakaway> found;
  constexpr double kStill_s = 1.0;  // at rest, and pressed, for that long before
  constexpr double kStill_rad = 0.004;
  constexpr double kLeastForce_N = 0.5;
  std::size_t i = 0;
  double last_s = -1e9;
  for (; i < rows.size(); ++i) {
    const double now_s = rows[i].time_s;
    if (now_s - rows.front().time_s < kStill_s || now_s - last_s < kStill_s) continue;
    // Rest: the window that ends a little before now.
    std::size_t first = i;
    while (first > 0 && now_s - rows[first - 1].time_s < kStill_s) --first;
    std::size_t last = i;
    while (last > first && now_s - rows[last].time_s < 0.15) --last;
    if (last < first + 5) continue;
    double rest_rad = 0.0;
    const std::size_t early = first + (last - first) / 3;
    for (std::size_t k = first; k <= early; ++k) rest_rad += rows[k].output_angle_rad;
    rest_rad /= static_cast<double>(early - first + 1);
    if (rest_rad - rows[i].output_angle_rad < kGone_rad) continue;
    bool still = true;
    for (std::size_t k = first; k <= last; ++k) {
      still = still && std::abs(rows[k].output_angle_rad - rest_rad) < kStill_rad;
    }
    if (!still) continue;
    // A parabola through the last rows, where the force is greatest: a soft hand gives way as the
    // contact creeps, so that the force bends over before the link goes. At a fixed time: the
    // largest of noisy rows, or of a parabola through them, would be too large. The very last rows
    // have the link's acceleration in them.
    std::vector<double> time_s, force_N;
    for (std::size_t k = i + 1; k-- > 0 && now_s - rows[k].time_s < kFitFrom_s;) {
      if (now_s - rows[k].time_s < kFitTo_s) continue;
      time_s.push_back(rows[k].time_s - now_s);
      force_N.push_back(rows[k].load_force_N);
    }
    if (time_s.size() < 8) continue;
    const double largest_N = ParabolaAt(time_s, force_N, -kRead_s);
    if (largest_N < kLeastForce_N) continue;
    found.push_back({rest_rad, largest_N, SlopeOf(time_s, force_N),
                     (time_s.front() - time_s.back()) / static_cast<double>(time_s.size() - 1)});
    last_s = now_s;
  }
  return found;
}

Result IdentifyBreakaway(const std::vector<Breakaway>& trials, const RigConstants& rig) {
  const auto n = static_cast<Eigen::Index>(trials.size());
  std::map<int, std::vector<double>> by_angle;  // degrees
  for (const Breakaway& trial : trials) {
    by_angle[static_cast<int>(std::lround(trial.angle_rad / types::kDegree_rad / 5.0) * 5)]
        .push_back(trial.force_N * rig.link_length_m);
  }
  if (n < 4 || by_angle.size() < 2) {
    throw std::invalid_argument("breakaway: " + std::to_string(n) + " trials at " +
                                std::to_string(by_angle.size()) +
                                " angles, expected at least 4 at 2 angles");
  }
  TrialRows of_trials;
  double rate_Nm_s = 0.0, row_s = 0.0;
  for (const Breakaway& t : trials) {
    of_trials.Add(static_cast<int>(of_trials.size()), Eigen::Vector2d(1.0, -std::cos(t.angle_rad)),
                  t.force_N * rig.link_length_m);
    rate_Nm_s += t.rate_N_s * rig.link_length_m / static_cast<double>(n);
    row_s += t.row_s / static_cast<double>(n);
  }
  const TrialFit fit = of_trials.Fit();
  Estimate friction = fit.At(0);
  // The instant of breaking away is known to one row: a bias of the force, not of its slope.
  friction.half_width_95 = std::hypot(friction.half_width_95, std::abs(rate_Nm_s) * row_s);

  Result result{.experiment = "breakaway", .title = "Torque to start moving (5.1.1)"};
  result.quantities = {
      Quantity{"static_friction_Nm", "static friction after a rest", "Nm", friction}
          .Published(1.22, "Fig 5.3")
          .WithinShare(0.05),
      Quantity{"gravity_Nm", "gravity, link level", "Nm", fit.At(1)}
          .Published(0.58, "(5.2)")
          .WithinShare(0.05)};
  report::Table table{
      .title = "Torque at the load cell to start moving (Fig 5.2)",
      .header = {"angle, degrees", "trials", "mean, Nm", "sd, Nm", "with gravity, Nm"}};
  report::Series measured{.name = "measured", .style = kBars}, fitted{.name = "fit"};
  report::Series total{.name = "measured + gravity", .style = kBars};
  for (const auto& [angle_deg, values] : by_angle) {
    const double mean = identify::Mean(values), sd = identify::StandardDeviation(values);
    const double with_gravity = mean + fit.b(1) * std::cos(angle_deg * types::kDegree_rad);
    table.rows.push_back({std::to_string(angle_deg), std::to_string(values.size()),
                          types::Text("%.4f", mean), types::Text("%.4f", sd),
                          types::Text("%.4f", with_gravity)});
    measured.Add(angle_deg, mean);
    measured.spread.push_back(sd);
    total.Add(angle_deg, with_gravity);
    total.spread.push_back(sd);
  }
  for (int angle_deg = -90; angle_deg <= 90; angle_deg += 3) {
    fitted.Add(angle_deg, fit.b(0) - fit.b(1) * std::cos(angle_deg * types::kDegree_rad));
  }
  result.tables.push_back(std::move(table));
  result.figures = {
      report::Chart("Torque to start rotating the shaft (Fig 5.2)",
                    "Mean and standard deviation at each angle; line: static friction less "
                    "gravity, fitted.",
                    "angle, degrees", kFigure_px,
                    {{"torque at the load cell, N m", {std::move(measured), std::move(fitted)}}}),
      report::Chart("With gravity (Fig 5.3)",
                    "Load cell plus fitted gravity: flat, where (5.1) and (5.2) hold.",
                    "angle, degrees", kFigure_px, {{"total torque, N m", {std::move(total)}}})};
  return result;
}

}  // namespace sinew::experiment
