// Rate, jitter, age and loss of a topic, from the arrival and the header of each message.
//
//   rate    (n - 1) / (last arrival - first arrival); none of a topic that has been silent for
//   longer
//           than that: a burst on request has no rate
//   jitter  standard deviation of the intervals between arrivals
//   age     arrival - header.stamp_ns: how old the measurement is when the message arrives
//   delay   arrival - the time at which DDS sent it
//   loss    missing ticks by gaps of header.tick within a session: a topic has a step of ticks (the
//           most frequent one); a gap of k steps is k - 1 lost messages
//
// Pure; one thread; memory does not grow with the number of messages.
#pragma once

#include <cstdint>
#include <map>
#include <optional>

namespace sinew::inspect {

struct Arrival {
  std::int64_t arrival_ns = 0;           // epoch; a recording's log time
  std::optional<std::int64_t> sent_ns;   // epoch, by the sender's clock; none in recordings
  std::optional<std::int64_t> stamp_ns;  // of the header
  std::optional<std::uint64_t> session_id, tick;
  bool is_replay = false;     // its stamp is of another time: no age
  bool from_history = false;  // sent before anybody listened (TRANSIENT_LOCAL): is counted alone
};

struct Spread {
  double mean = 0.0, deviation = 0.0, least = 0.0, largest = 0.0;
};

struct RateSummary {
  std::uint64_t messages = 0;  // those from history too
  double seconds = 0.0;        // from the first arrival to the last, without history
  std::optional<double> rate_Hz;
  std::optional<Spread> interval_ms;  // deviation: the jitter
  std::optional<Spread> age_ms;
  std::optional<Spread> delay_ms;
  // Step of topics that have one: at least half of the differences between ticks are equal.
  std::optional<std::uint64_t> tick_step;
  std::optional<std::uint64_t> lost;
  std::optional<double> lost_share;  // of what was sent
  std::uint64_t repeated = 0;        // ticks that came again, or late: two writers, disorder
  std::uint64_t sessions = 0;
};

class RateMeter {
 public:
  void Add(const Arrival& arrival);
  // end_ns: until when it was listened, epoch; none: until the last message.
  RateSummary Summary(std::optional<std::int64_t> end_ns = std::nullopt) const;

 private:
  // Welford 1962: mean and sum of squared deviations in one pass.
  struct Sum {
    std::uint64_t count = 0;
    double mean = 0.0, squares = 0.0, least = 0.0, largest = 0.0;
    void Add(double value);
    std::optional<Spread> Get() const;
  };

  std::uint64_t messages_ = 0, from_history_ = 0;
  std::int64_t first_ns_ = 0, last_ns_ = 0;
  Sum interval_ms_, age_ms_, delay_ms_;
  std::optional<std::uint64_t> session_, tick_;
  std::uint64_t sessions_ = 0, repeated_ = 0;
  std::map<std::uint64_t, std::uint64_t> steps_;  // difference of ticks -> how often
};

}  // namespace sinew::inspect
