#include "tools/sinew/recorded_time.h"

#include <algorithm>

namespace sinew::tools {

std::vector<RecordedSession> SessionsOf(const std::vector<StampedTick>& ticks) {
  std::vector<RecordedSession> sessions;
  std::map<std::uint64_t, std::map<std::uint64_t, std::int64_t>> stamps;  // by session and tick
  for (const StampedTick& one : ticks) {
    const auto [of_session, is_new] = stamps.try_emplace(one.session);
    if (is_new) sessions.push_back({one.session});
    of_session->second.try_emplace(one.tick, one.stamp_ns);
  }
  std::int64_t start_ns = 0, end_ns = 0;
  for (RecordedSession& session : sessions) {
    const auto& by_tick = stamps.at(session.id);
    const std::int64_t first_ns = by_tick.begin()->second;
    std::int64_t last_ns = first_ns;
    for (const auto& [tick, stamp_ns] : by_tick) last_ns = session.clock.Take(tick, stamp_ns);
    if (&session == &sessions.front()) start_ns = first_ns;
    session.add_ns = std::max(-start_ns, end_ns - first_ns);
    end_ns = last_ns + session.add_ns;
  }
  return sessions;
}

SpanMessages::SpanMessages(const recording::McapReader& reader,
                           const recording::MessageFilter& filter, const RecordedSpan& span)
    : reader_(reader),
      topics_(filter.topics),
      from_s_(span.from_s),
      to_s_(span.to_s),
      whole_(span.IsWhole()) {
  recording::MessageFilter read = filter;
  if (!whole_) {
    recording::MessageFilter clock;
    for (const auto& [id, channel] : reader.channels()) {
      if (channel.topic == kClockTopic) clock.topics = std::set<std::string>{kClockTopic};
      try {
        const recording::MessageType type = recording::MessageTypeOf(reader, channel);
        if (!recording::HasField(*type.type, "header.session_id")) continue;
        headers_.emplace(id, Header{type, recording::CdrField(*type.type, "header.session_id"),
                                    recording::CdrField(*type.type, "header.tick")});
      } catch (const recording::NotReadable&) {  // a foreign type
      } catch (const recording::CdrError&) {
      }
    }
    std::vector<StampedTick> ticks;
    recording::McapMessages messages = reader.Messages(clock);
    recording::McapMessage message;
    while (messages.Next(&message)) {
      if (const auto tick = TickOf(message)) ticks.push_back(*tick);
    }
    sessions_ = SessionsOf(ticks);
    if (read.topics) read.topics->insert(kClockTopic);
  }
  messages_.emplace(reader.Messages(read));
}

std::optional<StampedTick> SpanMessages::TickOf(const recording::McapMessage& message) const {
  const auto header = headers_.find(message.channel_id);
  if (header == headers_.end()) return std::nullopt;
  try {
    return StampedTick{static_cast<std::uint64_t>(header->second.session.AsInt(message.data)),
                       static_cast<std::uint64_t>(header->second.tick.AsInt(message.data)),
                       message.publish_time_ns};
  } catch (const recording::CdrError&) {  // a payload that is cut off
    return std::nullopt;
  }
}

bool SpanMessages::IsWithin(const recording::McapMessage& message) {
  if (whole_) return true;
  const std::optional<StampedTick> tick = TickOf(message);
  for (const RecordedSession& session : sessions_) {
    if (tick && session.id == tick->session) time_s_ = session.Time_s(*tick);
  }
  const std::string& topic = reader_.channels().at(message.channel_id).topic;
  return time_s_ >= from_s_ && time_s_ <= to_s_ && (!topics_ || topics_->contains(topic));
}

bool SpanMessages::Next(recording::McapMessage* message) {
  while (messages_->Next(message)) {
    if (IsWithin(*message)) return true;
  }
  return false;
}

}  // namespace sinew::tools
