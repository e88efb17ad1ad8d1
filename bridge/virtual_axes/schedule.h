// The due time of a message that is sent by itself, and the frames that are due together. Times are
// nanoseconds of one clock and come in. Allocates nothing.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "bridge/can/frame.h"

namespace sinew::virtual_axes {

inline constexpr std::int64_t kMs_ns = 1'000'000;

class Schedule {
 public:
  explicit Schedule(int every_ms = 0) : every_ns_(every_ms * kMs_ns) {}  // 0: never

  // First due `spread_ns` later, within the first period.
  void Start(std::int64_t now_ns, std::int64_t spread_ns) {
    if (every_ns_ > 0) at_ns_ = now_ns + spread_ns % every_ns_;
  }
  // True once for each time at which it is due; times that were missed are left out.
  bool IsDue(std::int64_t now_ns) {
    if (every_ns_ <= 0 || now_ns < at_ns_) return false;
    at_ns_ += every_ns_;
    if (at_ns_ <= now_ns) at_ns_ = now_ns + every_ns_;
    return true;
  }

 private:
  std::int64_t every_ns_;
  std::int64_t at_ns_ = 0;
};

// At most kFrames.
template <std::size_t kFrames>
class DueFrames {
 public:
  void Add(const can::Frame& frame) { frames_[count_++] = frame; }
  const can::Frame* begin() const { return frames_.data(); }
  const can::Frame* end() const { return frames_.data() + count_; }

 private:
  std::array<can::Frame, kFrames> frames_;
  std::size_t count_ = 0;
};

}  // namespace sinew::virtual_axes
