#include "components/provider/work_time.h"

#include <algorithm>

namespace sinew::provider {

void WorkTime::EndCycle() {
  const auto us = std::chrono::duration_cast<std::chrono::microseconds>(cycle_).count();
  ++count_[static_cast<std::size_t>(std::clamp<std::int64_t>(us, 0, kBins - 1))];
  ++cycles_;
  cycle_ = {};
}

double WorkTime::Quantile_us(double share) const {
  const double wanted = share * static_cast<double>(cycles_);
  double seen = 0.0;
  for (std::size_t bin = 0; bin < count_.size(); ++bin) {
    seen += count_[bin];
    if (seen > 0.0 && seen >= wanted) return static_cast<double>(bin + 1);
  }
  return 0.0;
}

}  // namespace sinew::provider
