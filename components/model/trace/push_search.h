// Pushes: pulses of one length, sign and size that pass, found in a residual by a matched filter.
// Pure; allocates.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "components/model/trace/event_search.h"
#include "components/model/trace/rules.h"

namespace sinew::trace {

// The pushes that stand out most by rules::kEventPeak and rules::kEventAlone; residual of every
// row, in units of the balance, as dry_friction, which only knows the direction of motion.
// has_play: teeth may touch.
std::optional<FoundEvent> FindPush(const identify::Design& design,
                                   std::shared_ptr<const effects::Effect> effect,
                                   double dry_friction, bool has_play,
                                   const Eigen::VectorXd& residual, const InForce& in_force);

// Instants, per recording, of pushes of a known length and size theta.
std::vector<std::vector<double>> LocatePushes(const identify::Design& design, double length_s,
                                              double theta, double dry_friction,
                                              const Eigen::VectorXd& residual);

}  // namespace sinew::trace
