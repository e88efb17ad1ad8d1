#include "components/record/recording/session_clock.h"

#include <iterator>

namespace sinew::recording {

std::int64_t SessionClock::Take(std::uint64_t tick, std::int64_t stamp_ns) {
  std::int64_t time_ns = stamp_ns + shift_ns_;
  if (begun_ && time_ns < last_ns_) {
    const auto ticks = static_cast<std::int64_t>(tick - last_tick_);
    shift_ns_ += last_ns_ + ticks * step_ns_ - time_ns;
    shifts_[tick] = shift_ns_;
    time_ns = stamp_ns + shift_ns_;
  } else if (begun_ && tick > last_tick_) {
    step_ns_ = (time_ns - last_ns_) / static_cast<std::int64_t>(tick - last_tick_);
  }
  begun_ = true;
  last_ns_ = time_ns;
  last_tick_ = tick;
  return time_ns;
}

std::int64_t SessionClock::ShiftOf(std::uint64_t tick) const {
  const auto next = shifts_.upper_bound(tick);
  return next == shifts_.begin() ? 0 : std::prev(next)->second;
}

bool TickOrder::Take(std::uint64_t session_id, std::uint64_t tick) {
  const auto [last, is_new] = last_.try_emplace(session_id, tick);
  if (!is_new && tick < last->second) return false;
  last->second = tick;
  return true;
}

}  // namespace sinew::recording
