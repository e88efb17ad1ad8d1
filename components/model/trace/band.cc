#include "components/model/trace/band.h"

#include <numbers>

#include "components/model/identify/balance.h"
#include "components/model/identify/design.h"
#include "components/model/identify/processing.h"
#include "components/model/identify/statistics.h"

namespace sinew::trace {

namespace {

// How far steps of sqrt(2) lead, and what share of the residual before each has to leave at most.
struct Steps {
  int most;
  double share;
};
constexpr Steps kWider = {6, 0.7};
// With an encoder on the motor, and with one at the output alone.
constexpr Steps kNarrower[] = {{2, 1.0}, {6, 0.9}};

// Recordings behind one low-pass, and what least squares with the declared terms leaves of them.
class Filtered {
 public:
  Filtered(const std::vector<types::Run>& runs, const actuator::JointModel& joint,
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

identify::ProcessingOptions BandOfLeastResidual(const std::vector<types::Run>& train,
                                                const std::vector<types::Run>& held_out,
                                                const actuator::JointModel& joint,
                                                double longest_gap_s) {
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
    for (int k = 0; k < steps.most; ++k, wider *= step) {
      Filtered next = at(wider);
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

}  // namespace sinew::trace
