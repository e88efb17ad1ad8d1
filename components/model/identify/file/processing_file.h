// The blocks `processing` and `as_published` of a model file.
//
//   processing:                    # every key may be left out: then the data decide
//     state_cutoff_Hz: 20          # position and pressure, before they are differentiated
//     state_order: 4
//     parallel_cutoff_Hz: 5        # drive and every column of regressors
//     parallel_order: 4
//     rest_velocity_rad_s: 0.03    # rest_velocity_m_s for linear joints; slower is rest or
//     reversal reversal_guard_s: 0.05       # left out on either side of rest and reversals
//     settle_distance_rad: 0.005   # settle_distance_m for linear joints; left out after them until
//     covered border_s: 0.5                # left out at both ends longest_gap_s: 0.25          #
//     longer gaps cut a recording into pieces
//   as_published:                  # optional: a publication's own processing, for comparison
//     filter_order: 4
//     cutoff_Hz: 100
//     border_samples: 50
//     decimate: 10
//     added_effects: [direction_dependent_viscous]
//
// Throws UsageError with file, line, key and what was expected.
#pragma once

#include <optional>

#include "components/base/config/config.h"
#include "components/model/effects/effect.h"
#include "components/model/identify/as_published.h"
#include "components/model/identify/processing.h"

namespace sinew::identify {

// root: the whole model file.
ProcessingOptions ReadProcessing(const config::Section& root, types::JointKind kind);
std::optional<AsPublishedOptions> ReadAsPublished(const config::Section& root);

}  // namespace sinew::identify
