#include "components/record/recording/session_clock.h"

#include <algorithm>
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

SessionTimes::SessionTimes(const std::vector<Tick>& ticks) {
  std::map<std::uint64_t, std::map<std::uint64_t, std::int64_t>> stamps;  // by session and tick
  for (const Tick& one : ticks) {
    const auto [of_session, is_new] = stamps.try_emplace(one.session);
    if (is_new) sessions_.push_back(one.session);
    of_session->second.try_emplace(one.tick, one.stamp_ns);
  }
  for (const std::uint64_t id : sessions_) {
    Session& session = by_id_[id];
    const std::int64_t first_ns = stamps.at(id).begin()->second;
    std::int64_t last_ns = first_ns;
    for (const auto& [tick, stamp_ns] : stamps.at(id)) {
      last_ns = session.clock.Take(tick, stamp_ns);
    }
    if (id == sessions_.front()) start_ns_ = end_ns_ = first_ns;
    session.add_ns = std::max<std::int64_t>(0, end_ns_ - first_ns);
    end_ns_ = last_ns + session.add_ns;
  }
}

std::int64_t SessionTimes::ShiftOf(std::uint64_t session, std::uint64_t tick) const {
  const auto found = by_id_.find(session);
  return found == by_id_.end() ? 0 : found->second.clock.ShiftOf(tick) + found->second.add_ns;
}

bool TickOrder::Take(std::uint64_t session_id, std::uint64_t tick) {
  const auto [last, is_new] = last_.try_emplace(session_id, tick);
  if (!is_new && tick < last->second) return false;
  last->second = tick;
  return true;
}

}  // namespace sinew::recording
