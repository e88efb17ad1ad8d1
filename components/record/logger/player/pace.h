// Instant at which a position of a recording is due on the wall clock: rate, pause, jumps.
//
// While it runs: wall = anchor_wall + (position - anchor_position) / rate. All times in
// nanoseconds; positions count from the first message that is played, wall times from any fixed
// instant of a clock that is never set back. Pure; one thread; allocates nothing.
#pragma once

#include <cstdint>
#include <optional>

namespace sinew::logger {

// As fast as it goes. Other rates are at least kLeastRate times real time.
inline constexpr double kMaxRate = 0.0;
inline constexpr double kLeastRate = 0.1;

class Pace {
 public:
  // Starts at position 0, at the wall time 0. Throws std::invalid_argument for a rate that is
  // neither kMaxRate nor a finite one of at least kLeastRate.
  explicit Pace(double rate);

  double rate() const { return rate_; }
  bool paused() const { return paused_; }

  // Position at an instant. At the maximum rate, and while paused: the last one that was set.
  std::int64_t PositionAt(std::int64_t wall_ns) const;
  // Instant at which a position is due; nothing while paused. At the maximum rate: at once, which
  // is `wall_ns`.
  std::optional<std::int64_t> DueAt(std::int64_t position_ns, std::int64_t wall_ns) const;

  // From here on at this position.
  void JumpTo(std::int64_t position_ns, std::int64_t wall_ns);
  // Throws as the constructor does, and then changes nothing.
  void SetRate(double rate, std::int64_t wall_ns);
  void Pause(std::int64_t wall_ns);
  void Resume(std::int64_t wall_ns);

 private:
  double rate_;
  bool paused_ = false;
  std::int64_t position_ns_ = 0;
  std::int64_t wall_ns_ = 0;
};

}  // namespace sinew::logger
