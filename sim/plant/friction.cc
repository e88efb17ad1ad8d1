#include "sim/plant/friction.h"

#include <algorithm>
#include <cmath>

namespace sinew::plant {

void ApplyImpulses(std::span<const double> inverse_inertia, std::span<const double> lower,
                   std::span<const double> upper, std::span<double> impulse,
                   std::span<double> velocity) noexcept {
  const std::size_t n = velocity.size();
  std::fill(impulse.begin(), impulse.end(), 0.0);
  const int rounds = n == 1 ? 1 : 100;
  for (int round = 0; round < rounds; ++round) {
    double largest = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      const double wanted = impulse[i] - velocity[i] / inverse_inertia[i * n + i];
      const double next = std::clamp(wanted, lower[i], upper[i]);
      const double change = next - impulse[i];
      if (change == 0.0) continue;
      impulse[i] = next;
      for (std::size_t k = 0; k < n; ++k) velocity[k] += inverse_inertia[k * n + i] * change;
      largest = std::max(largest, std::abs(inverse_inertia[i * n + i] * change));
    }
    if (!(largest > 1e-14)) break;
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (impulse[i] > lower[i] && impulse[i] < upper[i]) velocity[i] = 0.0;
  }
}

}  // namespace sinew::plant
