// Time of a recording from its start, as it is drawn and as `--from` and `--to` mean it: that of
// the messages, simulated in lockstep, from the first joint_state on; sessions follow each other.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "components/record/recording/cdr.h"
#include "components/record/recording/mcap_reader.h"
#include "components/record/recording/message_type.h"
#include "components/record/recording/session_clock.h"
#include "tools/sinew/recordings.h"

namespace sinew::tools {

// Topic whose stamps are the time, where it is recorded.
inline constexpr const char* kClockTopic = "joint_state";

struct StampedTick {
  std::uint64_t session = 0, tick = 0;
  std::int64_t stamp_ns = 0;
};

struct RecordedSession {
  std::uint64_t id = 0;
  recording::SessionClock clock{};
  std::int64_t add_ns = 0;  // to a stamp of the clock: time from the recording's start

  double Time_s(const StampedTick& at) const {
    return 1e-9 * static_cast<double>(at.stamp_ns + clock.ShiftOf(at.tick) + add_ns);
  }
};

// Sessions as they came, each not before the end of the one before: simulated time begins anew in
// each. Within a session time only goes on (session_clock.h).
std::vector<RecordedSession> SessionsOf(const std::vector<StampedTick>& ticks);

// Messages of a recording within a span of its time, in the order of the file. A message without a
// header has the time of the one before. The reader has to stay. Throws recording::McapError.
class SpanMessages {
 public:
  SpanMessages(const recording::McapReader& reader, const recording::MessageFilter& filter,
               const RecordedSpan& span);
  bool Next(recording::McapMessage* message);

 private:
  struct Header {
    recording::MessageType type;
    recording::CdrField session, tick;
  };
  std::optional<StampedTick> TickOf(const recording::McapMessage& message) const;
  bool IsWithin(const recording::McapMessage& message);

  const recording::McapReader& reader_;
  const std::optional<std::set<std::string>> topics_;
  const double from_s_, to_s_;
  const bool whole_;
  std::map<recording::ChannelId, Header> headers_;
  std::vector<RecordedSession> sessions_;
  double time_s_ = 0.0;
  std::optional<recording::McapMessages> messages_;
};

}  // namespace sinew::tools
