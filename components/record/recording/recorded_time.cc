#include "components/record/recording/recorded_time.h"

#include <set>
#include <string>
#include <vector>

namespace sinew::recording {
namespace {

constexpr const char* kTickTopic = "joint_state";

// Calls take(session, tick, message) for every joint_state that has a header.
template <class Headers, class Take>
void ForEachState(const McapReader& reader, const Headers& headers, bool in_file_order,
                  const Take& take) {
  MessageFilter filter;
  filter.topics = std::set<std::string>{kTickTopic};
  filter.in_file_order = in_file_order;
  McapMessages messages = reader.Messages(filter);
  McapMessage message;
  while (messages.Next(&message)) {
    const auto header = headers.find(message.channel_id);
    if (header == headers.end()) continue;
    try {
      take(static_cast<std::uint64_t>(header->second.session.AsInt(message.data)),
           static_cast<std::uint64_t>(header->second.tick.AsInt(message.data)), message);
    } catch (const CdrError&) {  // malformed, as it was recorded
    }
  }
}

}  // namespace

RecordedTime::RecordedTime(const McapReader& reader) {
  for (const auto& [id, channel] : reader.channels()) {
    try {
      const MessageType type = MessageTypeOf(reader, channel);
      if (!HasField(*type.type, "header.session_id") || !HasField(*type.type, "header.tick")) {
        continue;
      }
      headers_.emplace(id, Header{type, CdrField(*type.type, "header.session_id"),
                                  CdrField(*type.type, "header.tick")});
    } catch (const NotReadable&) {  // its messages have the time of reception
    }
  }
  std::optional<std::string> mode;
  for (const McapMetadata& metadata : reader.ReadMetadata()) {
    const auto found = metadata.values.find("mode");
    if (metadata.name == "sinew.recording" && found != metadata.values.end()) mode = found->second;
  }
  TickOrder order;
  std::vector<SessionTimes::Tick> ticks;
  ForEachState(reader, headers_, false,
               [&](std::uint64_t session, std::uint64_t tick, const McapMessage& message) {
                 in_file_order_ |= !order.Take(session, tick);
                 ticks.push_back({session, tick, message.publish_time_ns});
                 is_simulated_ |= !mode && message.publish_time_ns < kLeastEpochStamp_ns &&
                                  message.log_time_ns >= kLeastEpochStamp_ns;
               });
  if (in_file_order_) {  // sessions are in that order, too
    ticks.clear();
    ForEachState(reader, headers_, true,
                 [&](std::uint64_t session, std::uint64_t tick, const McapMessage& message) {
                   ticks.push_back({session, tick, message.publish_time_ns});
                 });
  }
  if (mode) is_simulated_ = *mode == "lockstep";
  if (!ticks.empty()) times_.emplace(ticks);
}

std::int64_t RecordedTime::Of(const McapMessage& message) const {
  const auto header = headers_.find(message.channel_id);
  if (!times_ || header == headers_.end()) return message.log_time_ns;
  try {
    const std::int64_t shift_ns =
        times_->ShiftOf(static_cast<std::uint64_t>(header->second.session.AsInt(message.data)),
                        static_cast<std::uint64_t>(header->second.tick.AsInt(message.data)));
    return shift_ns + (is_simulated_ ? message.publish_time_ns : message.log_time_ns);
  } catch (const CdrError&) {
    return message.log_time_ns;
  }
}

std::optional<RecordedTime::Span> RecordedTime::span() const {
  if (!times_ || !(is_simulated_ || in_file_order_)) return std::nullopt;
  return Span{times_->start_ns(), times_->end_ns()};
}

}  // namespace sinew::recording
