// Time of a recorded session that only goes on. Ticks of a session grow; the stamps of a live robot
// are those of a clock, which may be set back (NTP, on a computer without a battery for its clock).
// A later tick with an earlier stamp is that: from there on stamps are later by so much that time
// goes on by the step before it.
#pragma once

#include <cstdint>
#include <map>

namespace sinew::recording {

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

// Ticks of joint_state in the order of a file's log times.
class TickOrder {
 public:
  // False: the session had a later tick already, so that log times are no order of its messages.
  bool Take(std::uint64_t session_id, std::uint64_t tick);

 private:
  std::map<std::uint64_t, std::uint64_t> last_;  // by session
};

}  // namespace sinew::recording
