// Effects that begin at an instant and last, found in a residual as a change point of each
// recording. Pure; allocates.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "components/model/trace/event_search.h"

namespace sinew::trace {

// The change that explains most, of one size in all recordings that have it, beyond what the same
// search finds in residuals of random sign; residual of every row, in units of the balance.
std::optional<FoundEvent> FindChange(const identify::Design& design,
                                     std::shared_ptr<const effects::Effect> effect,
                                     const Likelihood& likelihood, const identify::FitResult& fit,
                                     const Eigen::VectorXd& residual, std::uint64_t seed);

// The instant, per recording, from which the effect with size theta explains most; none where it
// explains nothing.
std::vector<std::vector<double>> LocateChanges(const identify::Design& design,
                                               const effects::Effect& effect, double theta,
                                               const Eigen::VectorXd& residual);

}  // namespace sinew::trace
