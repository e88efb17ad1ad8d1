// Time of a recorded session that only goes on. Ticks of a session grow; the stamps of a live robot
// are those of a clock, which may be set back (NTP, on a computer without a battery for its clock).
// A later tick with an earlier stamp is that: from there on stamps are later by so much that time
// goes on by the step before it.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

namespace sinew::recording {

// Stamps before 2001-09-09 are not of an epoch clock: simulated time begins at 0, and a session of
// 31 years is none.
inline constexpr std::int64_t kLeastEpochStamp_ns = 1'000'000'000'000'000'000;

class SessionClock {
 public:
  // A tick of the session, later than those before. Its stamp, shifted.
  std::int64_t Take(std::uint64_t tick, std::int64_t stamp_ns);
  // By how much stamps are later from this tick on; of ticks that were taken.
  std::int64_t ShiftOf(std::uint64_t tick) const;
  // By how much the clock was set back, in all.
  std::int64_t set_back_ns() const { return shift_ns_; }

 private:
  std::map<std::uint64_t, std::int64_t> shifts_;  // by the first tick that has it
  std::int64_t shift_ns_ = 0, last_ns_ = 0, step_ns_ = 0;
  std::uint64_t last_tick_ = 0;
  bool begun_ = false;
};

// Sessions of a recording, each not before the end of the one before: simulated time begins anew in
// each.
class SessionTimes {
 public:
  struct Tick {
    std::uint64_t session = 0, tick = 0;
    std::int64_t stamp_ns = 0;
  };
  // Sessions are in the order of their first tick here; ticks of a session are in any order.
  explicit SessionTimes(const std::vector<Tick>& ticks);

  const std::vector<std::uint64_t>& sessions() const { return sessions_; }
  // By how much stamps are later; 0 of a session that is not here.
  std::int64_t ShiftOf(std::uint64_t session, std::uint64_t tick) const;
  std::int64_t start_ns() const { return start_ns_; }
  std::int64_t end_ns() const { return end_ns_; }

 private:
  struct Session {
    SessionClock clock{};
    std::int64_t add_ns = 0;  // to a time of the clock
  };
  std::vector<std::uint64_t> sessions_;
  std::map<std::uint64_t, Session> by_id_;
  std::int64_t start_ns_ = 0, end_ns_ = 0;
};

// Ticks of joint_state in the order of a file's log times.
class TickOrder {
 public:
  // False: the session had a later tick already, so that log times are no order of its messages.
  bool Take(std::uint64_t session_id, std::uint64_t tick);

 private:
  std::map<std::uint64_t, std::uint64_t> last_;  // by session
};

}  // namespace sinew::recording
