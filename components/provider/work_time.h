// How long a cycle's work takes, without its waits: from Resume to Pause, summed up to EndCycle.
// One thread; allocates at construction only.
#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

namespace sinew::provider {

class WorkTime {
 public:
  WorkTime() : count_(kBins, 0) {}

  void Resume() { since_ = Clock::now(); }
  void Pause() { cycle_ += Clock::now() - since_; }
  void EndCycle();

  std::uint64_t cycles() const { return cycles_; }
  // In microseconds, rounded up to a bin of 1 us; times beyond 20 ms count as that. 0 without cycles.
  double Quantile_us(double share) const;

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::size_t kBins = 20'000;

  std::vector<std::uint32_t> count_;  // by microseconds
  std::uint64_t cycles_ = 0;
  Clock::time_point since_{};
  Clock::duration cycle_{};
};

}  // namespace sinew::provider
