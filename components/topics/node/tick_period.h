// The time between the cycles of a loop, for code that integrates or differentiates over it.
//
// Pure, of one thread, no allocation.
#pragma once

#include <cstdint>
#include <optional>

namespace sinew::node {

// On a live robot and in a replay the period is measured, from successive stamps of the trigger. A
// simulated robot moves by its nominal period in every tick, whatever the clock of the process
// does: there the period is the nominal one times the ticks since the last cycle. The result is
// limited to kShortestPeriods and kLongestPeriods nominal periods:
//
// - the first tick of a session has no predecessor: nominal;
// - a stamp that does not advance (the clock was set back): nominal;
// - a gap counts as what passed, up to the limit. After 3 missed periods the state provider damps
//   the robot, so a longer gap is no step of one control action;
// - two samples close together (a late one, then one in time) count as half a period at least, so
//   that differences divided by the period stay bounded.
class TickPeriod {
 public:
  static constexpr double kShortestPeriods = 0.5;
  static constexpr double kLongestPeriods = 4.0;  // 3 missed periods and the one after them

  // Period of the next cycle, s; a nominal period that is not positive is returned as it is.
  // `simulated`: the origin of the trigger.
  double Next(std::uint64_t session_id, std::uint64_t tick, std::int64_t stamp_ns, bool simulated,
              double nominal_s) noexcept;

 private:
  struct Cycle {
    std::uint64_t session_id;
    std::uint64_t tick;
    std::int64_t stamp_ns;
  };
  std::optional<Cycle> last_;
};

}  // namespace sinew::node
