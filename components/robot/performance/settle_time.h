// The time after an event until a signal stays within a band of its plateau.
//
// Definition. With the event at t_e, the plateau c and the band b,
//
//     settle time = t_s - t_e,   t_s the first time >= t_e with |x(t) - c| <= b for all t >= t_s
//
// "For all t" is accepted after hold_s within the band, so the answer is known hold_s after t_s at
// the earliest. A signal that leaves the band later was not settled: the answer is withdrawn, the
// departure counted, and the search goes on; the last answer is the one of the definition.
//
// Plateau given (0 for a torque error, the sliding RMSE before a payload was put on): exactly the
// definition. Plateau not given: c is the mean over the last hold_s at the first time at which all
// samples since the event that lie in that window are within b of their mean; t_s is the window's
// beginning. For A exp(-t / T) -> 0 that c is a little above 0, and t_s comes early by
// T ln(1 / (1 - (T / hold_s) (1 - exp(-hold_s / T)))): 0.22 T for hold_s = 5 T, 0.11 T for 10 T.
//
// A lost sample (missing tick, not usable) neither confirms nor breaks. Where more than bridge_s
// pass without a sample before the answer, the search begins anew after them (what happened there
// was not seen); after the answer they are only counted.
//
// The signal's unit is the caller's: N m for a torque error, rad for an RMSE. Thread: one. Step is
// noexcept; allocates in the constructor only.
#pragma once

#include <cstdint>
#include <optional>

#include "components/robot/performance/energy.h"
#include "components/robot/performance/sliding_window.h"

namespace sinew::performance {

struct SettleConfig {
  double band = 0.0;              // b, positive, in the signal's unit
  double hold_s = 1.0;            // at least twice bridge_s, and a period
  std::optional<double> plateau;  // c; empty: estimated
  double bridge_s = kBridge_s;
};

struct SettleResult {
  enum class State { kNoEvent, kNotSettled, kSettled };
  State state = State::kNoEvent;
  double settle_s = 0.0;         // kSettled only
  double plateau = 0.0;          // c; kSettled only
  int departures = 0;            // answers withdrawn since the event
  std::uint64_t lost_ticks = 0;  // since the event
};

class SettleTime {
 public:
  // Throws std::invalid_argument for a figure out of range.
  SettleTime(const SettleConfig& config, double period_s);

  // The event happens at this tick: everything before is forgotten. Ticks before it are left out.
  void Event(std::uint64_t tick) noexcept;
  // The signal's sample of a tick. A tick that is not after the last one changes nothing.
  SettleResult Step(std::uint64_t tick, double value) noexcept;

 private:
  void StartSearch(std::uint64_t tick) noexcept;
  void Search(std::uint64_t tick) noexcept;

  SettleConfig config_;
  double period_s_;
  std::uint64_t hold_ticks_, bridge_ticks_;
  SlidingWindow window_;
  bool started_ = false;  // a sample was used since the event
  std::uint64_t event_tick_ = 0;
  std::uint64_t next_tick_ = 0;    // first one that is new
  std::uint64_t search_tick_ = 0;  // t_s is not before
  std::uint64_t sample_tick_ = 0;  // of the last usable sample
  SettleResult result_;
};

}  // namespace sinew::performance
