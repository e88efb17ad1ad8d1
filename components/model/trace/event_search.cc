#include "components/model/trace/event_search.h"

#include <utility>

#include "components/model/trace/candidates.h"
#include "components/model/trace/change_search.h"
#include "components/model/trace/nuisances.h"
#include "components/model/trace/push_search.h"
#include "components/model/trace/whitened_fit.h"

namespace sinew::trace {

std::vector<double> TimedEffect::Psi() const {
  std::vector<double> psi = {clock_s};
  if (passing()) psi.push_back(length_s);
  return psi;
}

std::optional<TimedEffect> FindTimedEffect(const identify::Design& design,
                                           const Likelihood& likelihood,
                                           const actuator::JointModel& declared,
                                           const identify::FitResult& fit, std::uint64_t seed) {
  if (declared.balance != effects::Balance::kMotion || design.states().locked ||
      design.options().state_cutoff_Hz <= 0.0) {
    return std::nullopt;
  }
  const Eigen::VectorXd residual = fit.balance.target - fit.balance.columns * fit.coefficients;
  const double scale = fit.balance.Unit(fit.coefficients);
  const double dry_friction = DryFriction(fit.model);
  std::optional<FoundEvent> best;
  for (const Candidate& candidate : EventCandidates(declared, likelihood.in_force)) {
    const bool passes = candidate.effect->info().nonlinear.size() > 1;
    std::optional<FoundEvent> found =
        passes ? FindPush(design, candidate.effect, dry_friction / scale,
                          declared.backlash_rad > 0.0, residual, likelihood.in_force)
               : FindChange(design, candidate.effect, likelihood, fit, residual, seed);
    if (found && (!best || found->explained > best->explained)) best = std::move(found);
  }
  if (!best) return std::nullopt;
  best->event.dry_friction = dry_friction;
  return std::move(best->event);
}

std::vector<std::vector<double>> LocateTimedEffect(const identify::Design& design,
                                                   const TimedEffect& event, double theta,
                                                   const Eigen::VectorXd& residual) {
  return event.passing() ? LocatePushes(design, event.length_s, theta, event.dry_friction, residual)
                         : LocateChanges(design, *event.effect, theta, residual);
}

void SetClocksBy(const TimedEffect& event, const std::vector<std::vector<double>>& start_s,
                 identify::Design* design) {
  for (std::size_t run = 0; run < start_s.size(); ++run) {
    design->SetClock(static_cast<int>(run), start_s[run], event.clock_s);
  }
}

}  // namespace sinew::trace
