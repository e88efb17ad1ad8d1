// Things that begin at an instant: a payload put on, a push from outside.
//
// When they begin differs from recording to recording and is no property of the robot. So the
// instant is looked for in every recording by itself, the recordings' clocks are set by it
// (identify::Design::SetClock), and from then on the effect is a hypothesis like every other, with
// the instants charged to it.
//
// An effect that lasts is a change point: for every instant the generalised likelihood ratio of the
// effect acting from there on, beside the declared terms (Basseville, Nikiforov 1993, section 2.4),
// against the same search with random signs of whole blocks. A push is detected by a matched filter
// over all moving rows, also those that a reversal it caused has masked, which have a noise of
// their own (what it explains is then counted on used rows alone); its peak is measured in robust
// standard deviations of the filter's output, and it has to stand apart from the next loudest
// places (push_search.cc). It may come several times, with one size. Pure; allocates.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "components/model/effects/effect.h"
#include "components/model/identify/balance.h"
#include "components/model/identify/design.h"
#include "components/model/trace/rules.h"

namespace sinew::trace {

struct Likelihood;  // whitened_fit.h

struct TimedEffect {
  std::shared_ptr<const effects::Effect> effect;
  std::vector<std::vector<double>> start_s;  // per recording, on its own stamps, rising
  double clock_s = 0.0;                      // where it begins once the clocks are set
  double length_s = 0.0;                     // of a push; 0: it lasts
  double dry_friction = 0.0;                 // of the joint, torque or force
  double charge = 0.0;  // misfit that the search for the instants may take from noise
  bool passing() const { return length_s > 0.0; }
  std::vector<double> Psi() const;
};

struct FoundEvent {
  TimedEffect event;
  double explained = 0.0;  // misfit
};

// The event that stands out most, if any does. fit: of the declared terms, with this likelihood;
// clocks are not touched.
std::optional<TimedEffect> FindTimedEffect(const identify::Design& design,
                                           const Likelihood& likelihood,
                                           const actuator::JointModel& declared,
                                           const identify::FitResult& fit, std::uint64_t seed);

// The same in other recordings, its size known: where it explains most of `residual`, in units of
// torque, every row (residual + theta * phi is noise), or nowhere. Per recording.
std::vector<std::vector<double>> LocateTimedEffect(const identify::Design& design,
                                                   const TimedEffect& event, double theta,
                                                   const Eigen::VectorXd& residual);

// Sets the clocks of a design so that it begins at clock_s in every recording; where it did not
// happen it never begins.
void SetClocksBy(const TimedEffect& event, const std::vector<std::vector<double>>& start_s,
                 identify::Design* design);

// Pushes (push_search.cc): those that stand out most by rules::kEventPeak and rules::kEventAlone;
// residual of every row, in units of the balance, as dry_friction, which only knows the direction
// of motion. has_play: teeth may touch.
std::optional<FoundEvent> FindPush(const identify::Design& design,
                                   std::shared_ptr<const effects::Effect> effect,
                                   double dry_friction, bool has_play,
                                   const Eigen::VectorXd& residual, const InForce& in_force);

// Instants, per recording, of pushes of a known length and size theta.
std::vector<std::vector<double>> LocatePushes(const identify::Design& design, double length_s,
                                              double theta, double dry_friction,
                                              const Eigen::VectorXd& residual);

}  // namespace sinew::trace
