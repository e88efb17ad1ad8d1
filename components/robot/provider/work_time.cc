#include "components/robot/provider/work_time.h"

#include <algorithm>

namespace sinew::provider {

void WorkTime::EndCycle() {
  ++count_[static_cast<std::size_t>(std::clamp<std::int64_t>(cycle_ns_ / 1000, 0, kBins - 1))];
  ++cycles_;
  cycle_ns_ = 0;
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
