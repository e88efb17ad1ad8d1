#include "tools/rerun/recorded_ticks.h"

#include <sinew_idl/joint.h>

#include <algorithm>
#include <iterator>
#include <set>

#include "components/base/config/config.h"
#include "components/record/recording/idl_schema.h"
#include "components/record/recording/recorded_time.h"
#include "components/topics/node/topics.h"

namespace sinew::rerun {
namespace {

node::Bytes Copy(std::span<const std::byte> data) { return {data.begin(), data.end()}; }

recording::MessageFilter Only(const std::vector<std::string>& topics, bool in_file_order) {
  recording::MessageFilter filter;
  filter.topics = std::set<std::string>(topics.begin(), topics.end());
  filter.in_file_order = in_file_order;
  return filter;
}

}  // namespace

void CheckTypes(const recording::McapReader& reader, const std::string& file,
                const std::vector<std::string>& topics) {
  for (const std::string& name : topics) {
    const node::TopicInfo* known = node::FindTopic(name);
    for (const auto& [id, channel] : reader.channels()) {
      if (channel.topic != name) continue;
      const recording::McapSchema* schema = reader.SchemaOf(channel);
      if (known != nullptr && schema != nullptr && schema->name == known->type_name &&
          recording::BareIdl(schema->data) == recording::BareIdl(known->idl)) {
        continue;
      }
      throw UsageError(file + ": topic '" + name +
                       "' was recorded with another type than this build's " +
                       (known != nullptr ? known->type_name : std::string("topics")) +
                       ", expected a recording of the same build or one with equal types");
    }
  }
}

void CheckWriters(const recording::McapReader& reader, const std::string& file,
                  const std::vector<std::string>& topics) {
  const auto& counts = reader.statistics().channel_message_counts;
  for (const std::string& name : topics) {
    const node::TopicInfo* info = node::FindTopic(name);
    if (info == nullptr || info->profile == node::Profile::kEvent) continue;
    std::set<std::string> writers;
    for (const auto& [id, channel] : reader.channels()) {
      const auto writer = channel.metadata.find("participant");
      const auto count = counts.find(id);
      const bool wrote = count != counts.end() && count->second > 0;
      if (channel.topic == name && wrote && writer != channel.metadata.end()) {
        writers.insert(writer->second);
      }
    }
    if (writers.size() < 2) continue;
    throw UsageError(file + ": topic '" + name + "' has several writers (" + *writers.begin() +
                     ", " + *std::next(writers.begin()) +
                     "), expected one: which of them was heard is not recorded");
  }
}

std::vector<Session> SessionsOf(const recording::McapReader& reader, const std::string& file) {
  CheckTypes(reader, file, {"joint_state"});
  std::vector<Session> sessions;
  const bool in_file_order = recording::RecordedTime(reader).in_file_order();
  recording::McapMessages messages = reader.Messages(Only({"joint_state"}, in_file_order));
  recording::McapMessage message;
  while (messages.Next(&message)) {
    node::HeadOfMessage head;
    if (!node::PeekHead(message.data.data(), message.data.size(), &head)) {
      throw UsageError(file + ": a joint_state has " + std::to_string(message.data.size()) +
                       " bytes, expected a message with its header");
    }
    auto session = std::find_if(sessions.begin(), sessions.end(),
                                [&](const Session& one) { return one.id == head.session_id; });
    if (session == sessions.end()) {
      msg::JointState state;
      if (!node::Decode(Copy(message.data), &state)) {
        throw UsageError(file + ": the joint_state of tick " + std::to_string(head.tick) +
                         " cannot be decoded");
      }
      session = sessions.insert(
          session, {head.session_id, head.tick, head.tick, 0, state.period_s, in_file_order});
    }
    session->last_tick = std::max(session->last_tick, head.tick);
    ++session->states;
  }
  return sessions;
}

RecordedTicks::RecordedTicks(const recording::McapReader& reader, const Session& session,
                             const std::vector<std::string>& topics)
    : reader_(reader),
      session_(session),
      messages_(reader.Messages(Only(topics, session.in_file_order))) {
  for (const auto& [id, channel] : reader_.channels()) {
    const node::TopicInfo* info = node::FindTopic(channel.topic);
    if (info == nullptr) continue;
    Topic& topic = recorded_[channel.topic];
    topic.is_event = info->profile == node::Profile::kEvent;
    by_channel_[id] = &topic;
    if (channel.topic == "joint_state") states_ = &topic;
  }
}

void RecordedTicks::ReadBeyond(std::uint64_t tick) {
  recording::McapMessage message;
  while (!at_end_) {
    if (!states_->by_tick.empty() && states_->by_tick.rbegin()->first > tick) return;
    if (!messages_.Next(&message)) {
      at_end_ = true;
      return;
    }
    node::HeadOfMessage head;
    if (!node::PeekHead(message.data.data(), message.data.size(), &head)) continue;
    Topic& topic = *by_channel_.at(message.channel_id);
    // An operator's command from before the session began may count in it.
    if (topic.is_event) topic.events.emplace(node::EventId(message.data), Copy(message.data));
    if (head.session_id != session_.id) continue;
    topic.by_tick[head.tick].push_back(Copy(message.data));
  }
}

std::optional<std::uint64_t> RecordedTicks::Next() {
  if (states_ == nullptr) return std::nullopt;
  ReadBeyond(tick_ ? *tick_ + kTicksKept : session_.first_tick + kTicksKept);
  const auto next = tick_ ? states_->by_tick.upper_bound(*tick_) : states_->by_tick.begin();
  if (next == states_->by_tick.end()) return std::nullopt;
  tick_ = next->first;
  if (*tick_ > kTicksKept) {
    for (auto& [name, topic] : recorded_) {
      // The newest one before may still be in force, such as a motion_request.
      auto kept = topic.by_tick.lower_bound(*tick_ - kTicksKept);
      if (kept != topic.by_tick.begin()) --kept;
      topic.by_tick.erase(topic.by_tick.begin(), kept);
    }
  }
  return tick_;
}

const std::vector<node::Bytes>* RecordedTicks::Find(std::string_view topic,
                                                    std::uint64_t tick) const {
  const auto found = recorded_.find(topic);
  if (found == recorded_.end()) return nullptr;
  const auto sent = found->second.by_tick.find(tick);
  return sent == found->second.by_tick.end() ? nullptr : &sent->second;
}

bool RecordedTicks::HasLater(std::string_view topic, std::uint64_t tick) const {
  const auto found = recorded_.find(topic);
  return found != recorded_.end() &&
         found->second.by_tick.upper_bound(tick) != found->second.by_tick.end();
}

const node::Bytes* RecordedTicks::FindEvent(std::string_view topic, std::uint64_t id) const {
  const auto found = recorded_.find(topic);
  if (found == recorded_.end()) return nullptr;
  const auto event = found->second.events.find(id);
  return event == found->second.events.end() ? nullptr : &event->second;
}

}  // namespace sinew::rerun
