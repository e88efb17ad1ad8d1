// Duration of a cycle's work, without its waits: from Resume to Pause, summed up to EndCycle.
// Pure: time is the caller's, of any clock that only goes forward. One thread; allocates at
// construction only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace sinew::provider {

class WorkTime {
 public:
  WorkTime() : count_(kBins, 0) {}

  void Resume(std::int64_t now_ns) { since_ns_ = now_ns; }
  void Pause(std::int64_t now_ns) { cycle_ns_ += now_ns - since_ns_; }
  void EndCycle();

  std::uint64_t cycles() const { return cycles_; }
  // In microseconds, rounded up to a bin of 1 us; times beyond 20 ms count as that. 0 without
  // cycles.
  double Quantile_us(double share) const;

 private:
  static constexpr std::size_t kBins = 20'000;

  std::vector<std::uint32_t> count_;  // by microseconds
  std::uint64_t cycles_ = 0;
  std::int64_t since_ns_ = 0;
  std::int64_t cycle_ns_ = 0;
};

}  // namespace sinew::provider
