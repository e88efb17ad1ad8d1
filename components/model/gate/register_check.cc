#include <algorithm>
#include <cmath>

#include "components/model/gate/checks.h"
#include "components/model/identify/statistics.h"

namespace sinew::gate {

namespace {

using types::Run;
using types::Signal;

constexpr Signal kWithSign[] = {Signal::kVelocity,     Signal::kMotorVelocity,
                                Signal::kMotorCurrent, Signal::kDriveVoltage,
                                Signal::kTorque,       Signal::kLoadForce};

// Two groups of sizes with nothing between them: [0, low] and [high, most].
struct Groups {
  double least = 0.0, low = 0.0, high = 0.0, most = 0.0;
  double gap() const { return high - low; }
  double range() const { return most - least; }
};

Groups GroupsOf(const Eigen::VectorXd& x) {
  std::vector<double> sizes(static_cast<std::size_t>(x.size()));
  for (Eigen::Index i = 0; i < x.size(); ++i) sizes[static_cast<std::size_t>(i)] = std::abs(x[i]);
  std::sort(sizes.begin(), sizes.end());
  Groups out{sizes.front(), sizes.front(), sizes.front(), sizes.back()};
  for (std::size_t i = 1; i < sizes.size(); ++i) {
    if (sizes[i] - sizes[i - 1] <= out.gap()) continue;
    out.low = sizes[i - 1];
    out.high = sizes[i];
  }
  return out;
}

// Do both groups hold the sizes of one quantity: from near 0 on, of like widths, and many of its
// steps? A drive that is on or off has a group that is noise alone, one about an offset none at 0.
bool HoldSizes(const Groups& groups, double step) {
  constexpr double kSteps = 20.0, kTenthOfLow = 0.1;
  constexpr double kAlike = 3.16;  // half an order of magnitude
  const double a = groups.low - groups.least, b = groups.most - groups.high;
  return groups.least <= kTenthOfLow * groups.low && std::min(a, b) > kSteps * step &&
         std::max(a, b) < kAlike * std::min(a, b);
}

// The direction of motion at instants with motion: the row next to each, and its sign.
struct Direction {
  Eigen::Index row = 0;
  bool forward = false;
};

std::vector<Direction> DirectionsOf(const Run& run, Signal angle) {
  constexpr double kMoves = 0.1;  // of the rms speed, as in the balance
  const double half = HalfWidth_s(run, angle);
  const std::vector<double> at = Centres(run, half, 4000);
  std::vector<Direction> out;
  if (at.size() < 50) return out;
  const Eigen::VectorXd rate = LocalCubics(run, {angle}, half, at).at(angle).rate;
  const double least = kMoves * identify::Rms(rate);
  Eigen::Index row = 0;
  for (std::size_t k = 0; k < at.size(); ++k) {
    while (row + 1 < run.size() && run.time_s[row] < at[k]) ++row;
    const double speed = rate[static_cast<Eigen::Index>(k)];
    if (std::abs(speed) > least) out.push_back({row, speed > 0.0});
  }
  return out;
}

// Does one group belong to each direction? A drive of as much friction as inertia leads the speed
// by an eighth of a period: three quarters of the instants agree.
bool FollowDirection(const Eigen::VectorXd& x, const Groups& groups,
                     const std::vector<Direction>& directions) {
  constexpr double kAgree = 0.75, kBothWays = 0.1;
  double agree = 0.0, forward = 0.0;
  for (const Direction& at : directions) {
    agree += (std::abs(x[at.row]) >= groups.high) == at.forward ? 1.0 : 0.0;
    forward += at.forward ? 1.0 : 0.0;
  }
  const double n = static_cast<double>(directions.size());
  return n > 0.0 && std::max(agree, n - agree) >= kAgree * n && forward > kBothWays * n &&
         forward < (1.0 - kBothWays) * n;
}

}  // namespace

std::vector<Measurement> CheckRegisters(const Run& run) {
  std::vector<Measurement> out;
  if (run.held || run.size() < 100) return out;
  const Signal angle = run.Has(Signal::kPosition) ? Signal::kPosition : Signal::kMotorPosition;
  if (!run.Has(angle) || !(Range(run.At(angle)) > 0.0)) return out;
  const std::vector<Direction> directions = DirectionsOf(run, angle);
  for (const Signal signal : kWithSign) {
    if (!run.Has(signal)) continue;
    const Eigen::VectorXd& x = run.At(signal);
    if (x.minCoeff() < 0.0 && x.maxCoeff() > 0.0) continue;
    const Groups groups = GroupsOf(x);
    if (!(groups.range() > 0.0) || !HoldSizes(groups, SmallestStep(x)) ||
        !FollowDirection(x, groups, directions)) {
      continue;
    }
    out.push_back(Measure("wrapped", signal, run, WholeRun(run), groups.gap() / groups.range(),
                          "its values lie in two groups, one for each direction of motion, with "
                          "nothing between " +
                              Number(groups.low) + " and " + Number(groups.high) +
                              ": the bit of the sign counts as a part of the number.",
                          "Write the channel as a signed number before it is mapped."));
  }
  return out;
}

}  // namespace sinew::gate
