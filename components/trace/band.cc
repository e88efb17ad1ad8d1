#include "components/trace/band.h"

#include <cmath>
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
  Filtered best(runs, joint, identify::FromMotion(runs, joint, longest_gap_s));
  // In at most so many steps, while each leaves less than that share of what the one before left.
  const auto follow = [&](int most, double share, const auto& options_of) {
    for (int k = 1; k <= most; ++k) {
      Filtered next(runs, joint, options_of(std::pow(std::numbers::sqrt2, k)));
      if (!Better(next, best, share)) return k > 1;
      best = std::move(next);
    }
    return true;
  };
  const bool wider = follow(kMostWider, kWorthIt, [&](double factor) {
    return identify::FromMotion(runs, joint, longest_gap_s, factor);
  });
  const identify::ProcessingOptions motion = best.options();
  if (!wider && motion.motor_cutoff_Hz > 0.0) {
    follow(kMostNarrower, 1.0, [&](double factor) {
      identify::ProcessingOptions options = motion;
      options.motor_cutoff_Hz /= factor;
      return options;
    });
  }
  return best.options();
}

}  // namespace sinew::trace
