#include "components/model/experiment/result.h"

#include <cmath>

namespace sinew::experiment {

std::optional<bool> Quantity::Met() const {
  if (!truth || (!target_absolute && !target_share)) return std::nullopt;
  const double limit = target_absolute ? *target_absolute : *target_share * std::abs(*truth);
  return std::abs(estimate.value - *truth) <= limit;
}

const Quantity* Result::Find(const std::string& id) const {
  for (const Quantity& quantity : quantities) {
    if (quantity.id == id) return &quantity;
  }
  return nullptr;
}

}  // namespace sinew::experiment
