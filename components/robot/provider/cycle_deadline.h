// Ends of the cycles of a loop in real time: absolute deadlines, one period apart, and the count of
// those that were missed.
//
// Pure: time is the caller's, of any clock that only goes forward. One thread; allocates nothing.
#pragma once

#include <chrono>
#include <cstdint>

namespace sinew::provider {

class CycleDeadline {
 public:
  CycleDeadline(std::chrono::nanoseconds period, std::int64_t start_ns)
      : period_ns_(period.count()), deadline_ns_(start_ns) {}

  // Starts the next cycle. Its end, of the caller's clock:
  std::int64_t Next() noexcept {
    deadline_ns_ += period_ns_;
    return deadline_ns_;
  }

  // At the end of a cycle's work. True: the deadline has passed, which counts as an overrun. After
  // more than a period the following deadlines move by the delay, so that no burst of cycles
  // catches up.
  bool Missed(std::int64_t now_ns) noexcept {
    const std::int64_t late_ns = now_ns - deadline_ns_;
    if (late_ns <= 0) return false;
    ++overruns_;
    if (late_ns > period_ns_) deadline_ns_ += late_ns;
    return true;
  }

  std::int64_t deadline_ns() const noexcept { return deadline_ns_; }
  std::uint64_t overruns() const noexcept { return overruns_; }

 private:
  std::int64_t period_ns_;
  std::int64_t deadline_ns_;
  std::uint64_t overruns_ = 0;
};

}  // namespace sinew::provider
