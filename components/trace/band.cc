#include "components/trace/band.h"

#include <numbers>

#include "components/identify/balance.h"
#include "components/identify/design.h"
#include "components/identify/processing.h"
#include "components/identify/statistics.h"

namespace sinew::trace {

namespace {

constexpr double kWorthIt = 0.7;  // of the residual before
constexpr int kMostSteps = 6;     // eight times as wide

double Left(const std::vector<identify::Run>& runs, const actuator::JointModel& joint,
            const identify::ProcessingOptions& options) {
  const identify::Design design(identify::MakeStates(runs, joint, options), options);
  const std::vector<Eigen::Index> rows = design.rows().UsedRows();
  const identify::Balance balance = identify::MakeBalance(design, joint);
  const Eigen::MatrixXd X = balance.columns(rows, Eigen::all);
  const Eigen::VectorXd y = balance.target(rows);
  return identify::Rms(identify::LeftBy(X, y));
}

}  // namespace

identify::ProcessingOptions BandOfLeastResidual(const std::vector<identify::Run>& runs,
                                                const actuator::JointModel& joint,
                                                double longest_gap_s) {
  double wider = 1.0;
  identify::ProcessingOptions best = identify::FromMotion(runs, joint, longest_gap_s, wider);
  double left = Left(runs, joint, best);
  for (int step = 0; step < kMostSteps; ++step) {
    wider *= std::numbers::sqrt2;
    const identify::ProcessingOptions next =
        identify::FromMotion(runs, joint, longest_gap_s, wider);
    const double now = Left(runs, joint, next);
    if (!(now < kWorthIt * left)) break;
    best = next;
    left = now;
  }
  return best;
}

}  // namespace sinew::trace
