#include "components/robot/fall/feet.h"

#include <cmath>
#include <cstddef>

namespace sinew::fall {

FootLoads LoadsOf(const FootForces& forces) noexcept {
  FootLoads loads;
  for (std::size_t i = 0; i < forces.force_N.size(); ++i) {
    if (!forces.valid[i] || !std::isfinite(forces.force_N[i])) continue;
    const bool right = i < forces.force_N.size() / 2;
    (right ? loads.right_N : loads.left_N) += forces.force_N[i];
    ++(right ? loads.right_sensors : loads.left_sensors);
  }
  return loads;
}

}  // namespace sinew::fall
