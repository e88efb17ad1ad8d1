#include "components/model/trace/band.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "components/model/identify/balance.h"
#include "components/model/identify/block_regression.h"
#include "components/model/identify/design.h"
#include "components/model/identify/processing.h"
#include "components/model/identify/statistics.h"
#include "components/model/trace/candidates.h"

namespace sinew::trace {

namespace {

// Steps of sqrt(2): how many at most, what share of the residual before each has to leave at most,
// and whether every effect of the catalogue stands beside the declared terms.
struct Steps {
  int most;
  double share;
  bool with_effects;
};
constexpr Steps kWider = {6, 0.7, false};
// With an encoder on the motor, and with one at the output alone.
constexpr Steps kNarrower[] = {{2, 1.0, true}, {6, 0.9, false}};

// Recordings behind one low-pass, and what least squares leaves of them.
class Filtered {
 public:
  Filtered(const std::vector<types::Run>& runs, const actuator::JointModel& joint,
           const identify::ProcessingOptions& options)
      : design_(identify::MakeStates(runs, joint, options), options),
        balance_(identify::MakeBalance(design_, joint)) {}

  const identify::ProcessingOptions& options() const { return design_.options(); }
  const std::vector<char>& used() const { return design_.rows().used; }

  // Puts the effects beside the declared terms, each at the middle of its grid.
  void AddEffects(const actuator::JointModel& joint, const InForce& in_force) {
    design_.PredictDrive(joint);
    for (const Candidate& candidate : MakeCandidates(design_, joint, in_force).candidates) {
      const Eigen::MatrixXd& more = candidate.grid[candidate.grid.size() / 2].columns;
      Eigen::MatrixXd& columns = balance_.columns;
      columns.conservativeResize(Eigen::NoChange, columns.cols() + more.cols());
      columns.rightCols(more.cols()) = more;
    }
  }

  double Left(const std::vector<Eigen::Index>& rows) const {
    const Eigen::MatrixXd X = balance_.columns(rows, Eigen::all);
    const Eigen::VectorXd y = balance_.target(rows);
    return identify::Rms(identify::LeftBy(X, y));
  }

 private:
  identify::Design design_;
  identify::Balance balance_;
};

// Does the first leave less than this share of what the second leaves, at the rows that both use?
bool Better(const Filtered& next, const Filtered& best, double share) {
  if (next.used().size() != best.used().size()) return false;
  std::vector<Eigen::Index> both;
  for (std::size_t i = 0; i < best.used().size(); ++i) {
    if (next.used()[i] && best.used()[i]) both.push_back(static_cast<Eigen::Index>(i));
  }
  return !both.empty() && next.Left(both) < share * best.Left(both);
}

}  // namespace

identify::ProcessingOptions BandOfLeastResidual(const std::vector<types::Run>& train,
                                                const std::vector<types::Run>& held_out,
                                                const actuator::JointModel& joint,
                                                double longest_gap_s, const InForce& in_force) {
  const bool motor = train.front().Has(types::Signal::kMotorPosition);
  const double least_Hz = motor ? 0.0 : identify::QuietBand(held_out, joint, longest_gap_s);
  const auto at = [&](double wider) {
    return Filtered(train, joint,
                    identify::FromMotion(train, joint, longest_gap_s, wider, least_Hz));
  };
  Filtered best = at(1.0);
  // In at most so many steps, while each leaves less than that share of what the one before left.
  const auto follow = [&](double step, const Steps& steps) {
    double wider = step;
    if (steps.with_effects) best.AddEffects(joint, in_force);
    for (int k = 0; k < steps.most; ++k, wider *= step) {
      Filtered next = at(wider);
      if (steps.with_effects) next.AddEffects(joint, in_force);
      if (!Better(next, best, steps.share)) return k > 0;
      best = std::move(next);
    }
    return true;
  };
  if (!follow(std::numbers::sqrt2, kWider)) {
    follow(1.0 / std::numbers::sqrt2, kNarrower[motor ? 0 : 1]);
  }
  return best.options();
}

double ContactGuard(const std::vector<types::Run>& train, const actuator::JointModel& joint,
                    const identify::ProcessingOptions& options) {
  if (!(joint.backlash_rad > 0.0) || !options.raw) return 0.0;
  const identify::Design design(identify::MakeStates(train, joint, options), options);
  const identify::Balance balance = identify::MakeBalance(design, joint);
  std::vector<std::pair<double, double>> rows;  // time from contact, residual
  const std::vector<Eigen::Index> used = design.rows().UsedRows();
  const Eigen::MatrixXd X = balance.columns(used, Eigen::all);
  const Eigen::VectorXd target = balance.target(used);
  const Eigen::VectorXd left = identify::LeftBy(X, target);
  for (std::size_t k = 0; k < used.size(); ++k) {
    const std::vector<double>& from_contact_s = design.SegmentOf(used[k]).from_contact_s;
    if (from_contact_s.empty()) return 0.0;
    rows.emplace_back(from_contact_s[design.rows().SampleOf(used[k])],
                      left[static_cast<Eigen::Index>(k)]);
  }
  std::sort(rows.begin(), rows.end());
  // In parts of a fiftieth of the rows; the farther half is far.
  constexpr std::size_t kParts = 50;
  constexpr double kLouder = 1.1;
  const std::size_t count = rows.size() / kParts;
  if (count < 20) return 0.0;
  const auto scale = [&](std::size_t first, std::size_t last) {
    std::vector<double> values;
    for (std::size_t k = first; k < last; ++k) values.push_back(rows[k].second);
    return identify::RobustDeviation(std::move(values));
  };
  const double far = scale(rows.size() / 2, rows.size());
  double guard_s = 0.0;
  for (std::size_t part = 0; 3 * (part + 1) <= kParts; ++part) {
    const std::size_t first = part * count;
    if (scale(first, first + count) < kLouder * far) break;
    guard_s = rows[first + count - 1].first;
  }
  return std::isfinite(guard_s) ? guard_s : 0.0;
}

}  // namespace sinew::trace
