// Sum, smallest, largest and number of the samples of the last N ticks.
//
// A running sum that adds the newest and subtracts the oldest sample keeps the rounding of every
// value that ever passed: a spike of 10^6 rad^2 leaves 10^-10 rad^2 behind for good. Here nothing
// is subtracted. The ticks are cut into blocks of N; the window is the end of the last block and
// the beginning of this one (van Herk, Pattern Recognition Letters 13 (1992) 517):
//
//     S = suffix_last[i + 1] + prefix_this[i]
//
// A sum of squares is then right to (N + 1) eps of itself, at any time. The suffixes are made once
// a block: N additions in one tick, two in every other. Lost samples have a place in the window,
// add nothing and are not counted.
// Thread: one. Allocates in the constructor only.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

namespace sinew::performance {

// A value that is summed here is at most so large, else it counts as lost: 10^150 times the ticks
// of any run, times any period, is finite.
inline constexpr double kMaxMagnitude = 1e150;

// Finite, and at most kMaxMagnitude.
bool IsUsable(double value) noexcept;

// Ticks of a time: floor(duration / period), a duration short of a whole tick by rounding
// (1e-9 ticks) is that tick. Throws std::invalid_argument unless the period is positive, the
// duration is not negative and there are at most 10^7 ticks.
int TicksOf(double duration_s, double period_s);

struct WindowSum {
  double sum = 0.0;
  double smallest = std::numeric_limits<double>::infinity();
  double largest = -std::numeric_limits<double>::infinity();
  int count = 0;
};

class SlidingWindow {
 public:
  // size: N, ticks. Throws std::invalid_argument below 1.
  explicit SlidingWindow(int size);

  // The sample of the next tick; one that is not usable is lost.
  void Push(double value) noexcept;
  // Ticks without a sample.
  void PushLost(std::uint64_t ticks) noexcept;
  void Clear() noexcept;

  // Over the last N ticks, or those since the beginning.
  WindowSum Sum() const noexcept;
  int size() const noexcept { return static_cast<int>(slots_.size()); }

 private:
  void PushSlot(const WindowSum& slot) noexcept;

  // Places 0 .. next_ - 1: this block's samples. The others: suffix sums of the last block.
  std::vector<WindowSum> slots_;
  std::size_t next_ = 0;
  WindowSum prefix_;  // of this block
};

}  // namespace sinew::performance
