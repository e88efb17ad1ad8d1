#include "components/base/simd/fastest.h"

#include <array>
#include <chrono>

namespace sinew::simd {

Instructions Fastest(const std::function<void(Instructions)>& run) {
  using Clock = std::chrono::steady_clock;
  std::array<Clock::duration, kAllInstructions.size()> least;
  least.fill(Clock::duration::max());
  for (int round = 0; round < kFastestRounds; ++round) {
    for (std::size_t i = 0; i < kAllInstructions.size(); ++i) {
      if (!Runs(kAllInstructions[i])) continue;
      const Clock::time_point start = Clock::now();
      run(kAllInstructions[i]);
      const Clock::duration time = Clock::now() - start;
      if (time < least[i]) least[i] = time;
    }
  }
  std::size_t best = 0;  // the portable set runs everywhere
  for (std::size_t i = 1; i < least.size(); ++i) {
    if (least[i] < least[best]) best = i;
  }
  return kAllInstructions[best];
}

}  // namespace sinew::simd
