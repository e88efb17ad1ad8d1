#include "components/trace/band.h"

#include <numbers>

#include "components/identify/balance.h"
#include "components/identify/design.h"
#include "components/identify/processing.h"
#include "components/identify/statistics.h"

namespace sinew::trace {

namespace {

constexpr double kWorthIt = 0.7;  // of the residual before
constexpr int kMostWider = 6;     // eight times as wide
constexpr int kMostNarrower = 2;  // half as wide

// Recordings behind one low-pass, and what least squares with the declared terms leaves of them.
class Filtered {
 public:
  Filtered(const std::vector<identify::Run>& runs, const actuator::JointModel& joint,
           const identify::ProcessingOptions& options)
      : design_(identify::MakeStates(runs, joint, options), options),
        balance_(identify::MakeBalance(design_, joint)) {}

  const identify::ProcessingOptions& options() const { return design_.options(); }
  const std::vector<char>& used() const { return design_.rows().used; }
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

identify::ProcessingOptions BandOfLeastResidual(const std::vector<identify::Run>& runs,
                                                const actuator::JointModel& joint,
                                                double longest_gap_s) {
  const auto at = [&](double wider) {
    return Filtered(runs, joint, identify::FromMotion(runs, joint, longest_gap_s, wider));
  };
  Filtered best = at(1.0);
  // In at most so many steps, while each leaves less than that share of what the one before left.
  const auto follow = [&](double step, int most, double share) {
    double wider = step;
    for (int k = 0; k < most; ++k, wider *= step) {
      Filtered next = at(wider);
      if (!Better(next, best, share)) return k > 0;
      best = std::move(next);
    }
    return true;
  };
  if (!follow(std::numbers::sqrt2, kMostWider, kWorthIt) && best.options().motor_cutoff_Hz > 0.0) {
    follow(1.0 / std::numbers::sqrt2, kMostNarrower, 1.0);
  }
  return best.options();
}

}  // namespace sinew::trace
