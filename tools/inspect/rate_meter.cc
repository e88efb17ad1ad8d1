#include "tools/inspect/rate_meter.h"

#include <algorithm>
#include <cmath>

#include "components/record/recording/session_clock.h"

namespace sinew::inspect {

namespace {

// Distinct differences of ticks that are kept apart; a topic with a step has few, and all larger
// ones count with the largest.
constexpr std::size_t kMostSteps = 256;

double Milliseconds(std::int64_t ns) { return static_cast<double>(ns) * 1e-6; }

}  // namespace

void RateMeter::Sum::Add(double value) {
  least = count == 0 ? value : std::min(least, value);
  largest = count == 0 ? value : std::max(largest, value);
  ++count;
  const double off = value - mean;
  mean += off / static_cast<double>(count);
  squares += off * (value - mean);
}

std::optional<Spread> RateMeter::Sum::Get() const {
  if (count == 0) return std::nullopt;
  return Spread{mean, std::sqrt(squares / static_cast<double>(count)), least, largest};
}

void RateMeter::Add(const Arrival& arrival) {
  if (arrival.from_history) {
    ++from_history_;
    return;
  }
  if (messages_ == 0) {
    first_ns_ = arrival.arrival_ns;
  } else {
    interval_ms_.Add(Milliseconds(arrival.arrival_ns - last_ns_));
  }
  last_ns_ = arrival.arrival_ns;
  ++messages_;
  if (arrival.sent_ns) delay_ms_.Add(Milliseconds(arrival.arrival_ns - *arrival.sent_ns));
  // An age against simulated time has no meaning.
  if (arrival.stamp_ns && !arrival.is_replay &&
      *arrival.stamp_ns >= recording::kLeastEpochStamp_ns) {
    age_ms_.Add(Milliseconds(arrival.arrival_ns - *arrival.stamp_ns));
  }
  if (!arrival.session_id) return;
  if (session_ != arrival.session_id) {
    ++sessions_;
    session_ = arrival.session_id;
    tick_ = arrival.tick;
    return;
  }
  if (!arrival.tick || !tick_) return;
  if (*arrival.tick <= *tick_) {
    ++repeated_;
    return;
  }
  const std::uint64_t step = *arrival.tick - *tick_;
  tick_ = arrival.tick;
  if (steps_.size() < kMostSteps || steps_.contains(step)) {
    ++steps_[step];
  } else {
    ++steps_.rbegin()->second;
  }
}

RateSummary RateMeter::Summary(std::optional<std::int64_t> end_ns) const {
  RateSummary summary;
  summary.messages = messages_ + from_history_;
  summary.seconds = static_cast<double>(last_ns_ - first_ns_) * 1e-9;
  const std::int64_t silent_ns = end_ns.value_or(last_ns_) - last_ns_;
  if (messages_ > 1 && last_ns_ > first_ns_ && silent_ns <= last_ns_ - first_ns_) {
    summary.rate_Hz = static_cast<double>(messages_ - 1) / summary.seconds;
  }
  summary.interval_ms = interval_ms_.Get();
  summary.age_ms = age_ms_.Get();
  summary.delay_ms = delay_ms_.Get();
  summary.repeated = repeated_;
  summary.sessions = sessions_;

  std::uint64_t differences = 0, most = 0, step = 0;
  for (const auto& [difference, count] : steps_) {
    differences += count;
    if (count > most) {
      most = count;
      step = difference;
    }
  }
  if (differences == 0 || 2 * most < differences) return summary;
  std::uint64_t lost = 0;
  for (const auto& [difference, count] : steps_) {
    const std::uint64_t steps = (difference + step / 2) / step;  // to the nearest
    if (steps > 1) lost += (steps - 1) * count;
  }
  summary.tick_step = step;
  summary.lost = lost;
  summary.lost_share = static_cast<double>(lost) / static_cast<double>(lost + messages_);
  return summary;
}

}  // namespace sinew::inspect
