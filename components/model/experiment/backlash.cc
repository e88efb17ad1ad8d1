#include "components/model/experiment/backlash.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "components/base/types/angle.h"
#include "components/base/types/control_mode.h"
#include "components/model/identify/statistics.h"

namespace sinew::experiment {
namespace {

constexpr double kLargestHand_N = 30.0;
constexpr double kCurrentFloor_A = 0.25;  // below it the current has no sign
constexpr double kShortestHalf_s = 0.5;   // of a half period
constexpr double kSettledShare = 0.6;     // of a half period until the contact is at rest
constexpr double kLeaveShare = 0.04;      // its end
constexpr double kSameLevel_Nm = 0.05;    // torques at the output that count as different levels

struct Half {
  int side = 0;
  double start_s = 0.0, end_s = 0.0;
  double sum_d_rad = 0.0, sum_torque_Nm = 0.0;
  double sum_d2_rad2 = 0.0;
  int rows = 0;
  double largest_rad = -1e9, smallest_rad = 1e9;
};

// Half widths, at 95 %, of what the rounding of the output's encoder leaves in the play and in the
// compliance.
struct Rounding {
  double play_deg = 0.0;
  double compliance_deg_Nm = 0.0;
};
Rounding RoundingOf(const std::vector<double>& variance_rad2, double lowest_Nm, double highest_Nm,
                    const RigConstants& rig) {
  const double largest_deg =
      LargestRounding(identify::Mean(variance_rad2), types::kTwoPi / rig.encoder_counts) /
      types::kDegree_rad;
  // Each contact at each torque rests at a phase of its own of the count: a sine of that amplitude,
  // so that the difference of two contacts has it as its standard deviation. The play is
  // extrapolated from two torques, the compliance is their difference.
  const double span_Nm = highest_Nm - lowest_Nm;
  constexpr double kNormal = 1.96;
  return {kNormal * largest_deg * std::hypot(highest_Nm, lowest_Nm) / span_Nm,
          kNormal * largest_deg * std::numbers::sqrt2 / span_Nm};
}

// Half periods: stretches of one sign of the current.
std::vector<Half> HalvesOf(const Recording& rows, const RigConstants& rig) {
  std::vector<Half> halves;
  int side = 0;
  for (const Row& row : rows) {
    const int now = row.motor_current_A > kCurrentFloor_A    ? 1
                    : row.motor_current_A < -kCurrentFloor_A ? -1
                                                             : side;
    if (now == 0) continue;
    if (now != side) {
      halves.push_back({.side = now, .start_s = row.time_s});
      side = now;
    }
    halves.back().end_s = row.time_s;
  }
  std::size_t half = 0;
  const double to_output = rig.efficiency * rig.gear_ratio * rig.torque_constant_Nm_A;
  for (const Row& row : rows) {
    while (half < halves.size() && row.time_s > halves[half].end_s) ++half;
    if (half == halves.size() || row.time_s < halves[half].start_s) continue;
    Half& h = halves[half];
    const double d_rad = row.motor_angle_rad / rig.gear_ratio - row.output_angle_rad;
    h.largest_rad = std::max(h.largest_rad, d_rad);
    h.smallest_rad = std::min(h.smallest_rad, d_rad);
    const double share = (row.time_s - h.start_s) / std::max(1e-9, h.end_s - h.start_s);
    if (share < kSettledShare || share > 1.0 - kLeaveShare) continue;
    h.sum_d_rad += d_rad;
    h.sum_d2_rad2 += d_rad * d_rad;
    h.sum_torque_Nm += to_output * row.motor_current_A;
    ++h.rows;
  }
  // A trial is a half up and the half down after it; what held the link before is neither.
  std::erase_if(halves, [](const Half& h) { return h.end_s - h.start_s < kShortestHalf_s; });
  return halves;
}

}  // namespace

BacklashProtocol::BacklashProtocol(const BacklashPlan& plan) : plan_(plan) {
  if (plan.trials < 1 || !(plan.period_s > 0.0) || !(plan.motor_torque_Nm > 0.0) ||
      !(plan.second_motor_torque_Nm > 0.0)) {
    throw std::invalid_argument("backlash: trials, period and torques must be positive");
  }
}

Command BacklashProtocol::Step(const Reading& reading) noexcept {
  Command command;
  const double periods = reading.time_s / plan_.period_s;
  const int trial = static_cast<int>(periods);
  if (trial >= plan_.trials) {
    done_ = true;
    return command;
  }
  const double torque_Nm = trial % 2 == 0 ? plan_.motor_torque_Nm : plan_.second_motor_torque_Nm;
  command.drive = types::ControlMode::kTorque;
  command.motor_torque_Nm = periods - trial < 0.5 ? torque_Nm : -torque_Nm;
  command.hand_force_N = std::clamp(plan_.hand_N_rad * reading.output_angle_rad +
                                        plan_.hand_N_s_rad * reading.output_velocity_rad_s,
                                    -kLargestHand_N, kLargestHand_N);
  return command;
}

Result IdentifyBacklash(const Recording& rows, const RigConstants& rig) {
  const std::vector<Half> halves = HalvesOf(rows, rig);
  std::vector<double> published_deg, width_deg, torque_Nm, variance_rad2;
  for (std::size_t i = 0; i + 1 < halves.size(); ++i) {
    const Half& up = halves[i];
    const Half& down = halves[i + 1];
    if (up.side < 0 || down.side > 0 || up.rows < 5 || down.rows < 5) continue;
    ++i;
    for (const Half* h : {&up, &down}) {
      const double mean_rad = h->sum_d_rad / h->rows;
      variance_rad2.push_back(std::max(0.0, h->sum_d2_rad2 / h->rows - mean_rad * mean_rad));
    }
    published_deg.push_back((std::max(up.largest_rad, down.largest_rad) -
                             std::min(up.smallest_rad, down.smallest_rad)) /
                            types::kDegree_rad);
    width_deg.push_back((up.sum_d_rad / up.rows - down.sum_d_rad / down.rows) * up.side /
                        types::kDegree_rad);
    torque_Nm.push_back(std::abs(up.sum_torque_Nm / up.rows) +
                        std::abs(down.sum_torque_Nm / down.rows));
  }
  if (width_deg.size() < 4) {
    throw std::invalid_argument("backlash: " + std::to_string(width_deg.size()) +
                                " whole periods in the recording, expected at least 4");
  }
  const auto [lowest, highest] = std::minmax_element(torque_Nm.begin(), torque_Nm.end());
  if (*highest - *lowest < kSameLevel_Nm) {
    throw std::invalid_argument(
        "backlash: all trials have the same torque, expected two to separate play from compliance");
  }
  TrialRows trials;
  for (std::size_t k = 0; k < width_deg.size(); ++k) {
    trials.Add(static_cast<int>(k), Eigen::Vector2d(1.0, torque_Nm[k]), width_deg[k]);
  }
  const TrialFit fit = trials.Fit();
  const Rounding rounding = RoundingOf(variance_rad2, *lowest, *highest, rig);
  Estimate play = fit.At(0), compliance = fit.At(1);
  play.half_width_95 = std::hypot(play.half_width_95, rounding.play_deg);
  compliance.half_width_95 = std::hypot(compliance.half_width_95, rounding.compliance_deg_Nm);

  Result result{.experiment = "backlash", .title = "Play of the gear (5.1.1)"};
  result.quantities = {
      Quantity{"backlash_deg", "backlash", "degrees", play,
               "difference of the contacts, extrapolated to no torque"}
          .Published(2.66, "Fig 5.1, mean of 100")
          .Within(0.05),
      Quantity{"backlash_extremes_deg", "largest minus smallest", "degrees",
               MeanOfTrials(published_deg),
               "as published; extremes of noisy counts and bent teeth widen it"}
          .Published(2.66, "Fig 5.1")
          .Within(0.05)
          .WithoutInterval(),
      Quantity{"contact_compliance_deg_Nm", "compliance of the contact", "degrees/Nm", compliance}};
  report::Series difference{.name = "motor/N - link"};
  const double begin_s = halves.empty() ? 0.0 : halves.front().start_s;
  for (const Row& row : rows) {
    if (row.time_s < begin_s || row.time_s > begin_s + 12.5) continue;
    difference.Add(
        row.time_s - begin_s,
        (row.motor_angle_rad / rig.gear_ratio - row.output_angle_rad) / types::kDegree_rad);
  }
  result.figures = {
      report::Chart("Difference of motor angle / N and link angle (Fig 5.1)",
                    "The first trials. Plateaus are the two contacts.", "time, s", kFigure_px,
                    {{"difference, degrees", {std::move(difference)}}}),
      report::Chart("Play by trial",
                    "Each trial's difference of contacts, at its torque at the teeth.",
                    "torque of both contacts, N m", kFigure_px,
                    {{"difference of contacts, degrees",
                      {{.name = "trials", .x = torque_Nm, .y = width_deg, .style = kPoints}}}})};
  return result;
}

}  // namespace sinew::experiment
