#include "reproduction/laboratory/coverage.h"

#include <algorithm>
#include <cmath>

namespace sinew::laboratory {

void CoverageCount::Add(const experiment::Result& result) {
  for (const experiment::Quantity& quantity : result.quantities) {
    if (!quantity.truth || !quantity.has_interval || *quantity.truth == 0.0) continue;
    Coverage& coverage = by_id_[quantity.id];
    const double truth = *quantity.truth;
    const double error = (quantity.estimate.value - truth) / std::abs(truth);
    const int n = ++coverage.seeds;
    coverage.covered += quantity.estimate.Covers(truth) ? 1 : 0;
    if (const auto met = quantity.Met()) {
      coverage.has_target = true;
      coverage.met += *met ? 1 : 0;
    }
    coverage.largest_error = std::max(coverage.largest_error, std::abs(error));
    coverage.mean_error += (error - coverage.mean_error) / n;
    coverage.mean_half_width +=
        (quantity.estimate.half_width_95 / std::abs(truth) - coverage.mean_half_width) / n;
  }
}

}  // namespace sinew::laboratory
