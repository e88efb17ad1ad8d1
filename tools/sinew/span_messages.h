// Messages of a recording within a span of its time.
#pragma once

#include "components/record/recording/mcap_reader.h"
#include "components/record/recording/recorded_time.h"
#include "tools/sinew/recordings.h"

namespace sinew::tools {

// In the order of the ticks. Time (recorded_time.h) is simulated in lockstep, from the first
// joint_state on, else of reception, from the first message on. Reader and span have to stay.
// Throws recording::McapError.
class SpanMessages {
 public:
  SpanMessages(const recording::McapReader& reader, recording::MessageFilter filter,
               const RecordedSpan& span)
      : time_(reader),
        start_ns_(time_.span() ? time_.span()->start_ns : reader.statistics().start_time_ns),
        span_(span),
        messages_(reader.Messages(InOrder(std::move(filter)))) {}

  bool Next(recording::McapMessage* message) {
    while (messages_.Next(message)) {
      if (span_.IsWhole()) return true;
      const double time_s = 1e-9 * static_cast<double>(time_.Of(*message) - start_ns_);
      if (time_s >= span_.from_s && time_s <= span_.to_s) return true;
    }
    return false;
  }
  const recording::RecordedTime& time() const { return time_; }

 private:
  recording::MessageFilter InOrder(recording::MessageFilter filter) const {
    filter.in_file_order = time_.in_file_order();
    return filter;
  }

  const recording::RecordedTime time_;
  const std::int64_t start_ns_;
  const RecordedSpan& span_;
  recording::McapMessages messages_;
};

}  // namespace sinew::tools
