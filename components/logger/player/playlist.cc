#include "components/logger/player/playlist.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "components/recording/idl_schema.h"

namespace sinew::logger {

using recording::CdrField;
using recording::IdlSchema;
using recording::IdlType;
using recording::McapChannel;
using recording::McapMessage;
using recording::McapSchema;

namespace {

constexpr std::int64_t kOriginReplay = 2;  // msg::ORIGIN_REPLAY
const std::set<std::string> kNotByDefault = {"component_status", "recording_progress"};

const recording::TopicSchema* Find(const std::vector<recording::TopicSchema>& known,
                                   const std::string& name) {
  for (const recording::TopicSchema& schema : known) {
    if (schema.topic == name) return &schema;
  }
  return nullptr;
}

// A topic with several writers has several channels.
void AddOnce(const std::string& name, std::vector<std::string>* names) {
  if (std::find(names->begin(), names->end(), name) == names->end()) names->push_back(name);
}

}  // namespace

struct Playlist::Channel {
  Channel(const McapSchema& schema, std::size_t topic_index)
      : topic(topic_index),
        idl(IdlSchema::Parse(schema.data)),
        type(idl.Struct(schema.name)),
        session_id(type, "header.session_id"),
        tick(type, "header.tick"),
        stamp_ns(type, "header.stamp_ns"),
        origin(type, "header.origin") {}

  std::size_t topic;
  IdlSchema idl;
  const IdlType& type;
  CdrField session_id, tick, stamp_ns, origin;
  std::optional<CdrField> last_tick;  // joint_state only
};

Playlist::Playlist(const recording::McapReader& reader, const std::string& file,
                   const std::vector<recording::TopicSchema>& known,
                   const PlaylistOptions& options) {
  std::set<std::string> recorded;
  for (const auto& [id, channel] : reader.channels()) recorded.insert(channel.topic);
  std::string list;
  for (const std::string& name : recorded) list += (list.empty() ? "" : ", ") + name;
  const auto require = [&](const std::string& option, const std::string& name) {
    if (recorded.contains(name)) return;
    throw std::invalid_argument(option + ": topic '" + name + "' is not in " + file +
                                ", expected one of: " + list);
  };
  for (const std::string& name : options.topics) require("--topics", name);
  for (const auto& [from, to] : options.remap) {
    require("--remap", from);
    if (Find(known, to) == nullptr)
      throw std::invalid_argument("--remap: no topic '" + to + "' in this build");
  }

  recording::MessageFilter filter;
  filter.topics.emplace();
  for (const auto& [id, channel] : reader.channels()) {
    const bool named = std::find(options.topics.begin(), options.topics.end(), channel.topic) !=
                       options.topics.end();
    if (!named && (!options.topics.empty() || kNotByDefault.contains(channel.topic))) continue;
    if (!named && std::find(options.only_when_named.begin(), options.only_when_named.end(),
                            channel.topic) != options.only_when_named.end()) {
      AddOnce(channel.topic, &not_named_);
      continue;
    }
    const auto remapped = options.remap.find(channel.topic);
    const std::string name = remapped == options.remap.end() ? channel.topic : remapped->second;
    const recording::TopicSchema* ours = Find(known, name);
    const McapSchema* theirs = reader.SchemaOf(channel);
    if (ours == nullptr) {
      if (named)
        throw std::invalid_argument(file + ": topic '" + name + "' is not known to this build");
      AddOnce(channel.topic, &left_out_);
      continue;
    }
    const bool same = theirs != nullptr && channel.message_encoding == "cdr" &&
                      theirs->encoding == "omgidl" && theirs->name == ours->type_name &&
                      recording::BareIdl(theirs->data) == recording::BareIdl(ours->idl);
    if (!same) {
      const auto hash = channel.metadata.find("idl_hash");
      throw std::invalid_argument(
          file + ": topic '" + channel.topic + "' was recorded with another type (" +
          (theirs == nullptr ? "no schema" : theirs->name) + ", hash " +
          (hash == channel.metadata.end() ? "unknown" : hash->second) + ") than this build's " +
          ours->type_name + " (hash " + ours->idl_hash +
          "): play it with the build that recorded it, or leave the topic out");
    }
    std::size_t index = 0;
    while (index < published_.size() && published_[index] != name) ++index;
    auto made = std::make_unique<Channel>(*theirs, index);
    if (name == "joint_state") made->last_tick.emplace(made->type, "last_tick");
    if (index == published_.size()) {
      published_.push_back(name);
      by_topic_.push_back(made.get());
    }
    channels_[id] = std::move(made);
    filter.topics->insert(channel.topic);
  }

  if (channels_.empty()) {
    throw std::invalid_argument(
        file + ": no topic to play" +
        (not_named_.empty() ? ""
                            : "; those in it command, and are played when --topics names them"));
  }
  const recording::McapStatistics& statistics = reader.statistics();
  const auto offset = [&statistics](double seconds) {
    const double ns = std::min(seconds * 1e9, 9e18 - static_cast<double>(statistics.start_time_ns));
    return statistics.start_time_ns + static_cast<std::int64_t>(std::llround(ns));
  };
  filter.start_ns = offset(options.start_s);
  filter.end_ns = offset(options.end_s);
  // Once through, to know what there is: reading costs little beside sending.
  recording::McapMessages messages = reader.Messages(filter);
  McapMessage message;
  std::int64_t last_ns = 0;
  while (messages.Next(&message)) {
    if (message_count_ == 0) first_ns_ = message.log_time_ns;
    last_ns = message.log_time_ns;
    ++message_count_;
    if (channels_.at(message.channel_id)->last_tick) ++state_count_;
  }
  if (message_count_ == 0)
    throw std::invalid_argument(file + ": no message between the start and end asked for");
  duration_ns_ = last_ns - first_ns_;
  messages_.emplace(reader.Messages(filter));
}

Playlist::~Playlist() = default;

bool Playlist::Next(PlayedMessage* message) {
  McapMessage recorded;
  if (!messages_->Next(&recorded)) return false;
  const Channel& channel = *channels_.at(recorded.channel_id);
  message->topic = channel.topic;
  message->due_ns = recorded.log_time_ns - first_ns_;
  message->payload.assign(recorded.data.begin(), recorded.data.end());
  message->is_state = channel.last_tick.has_value();
  try {
    message->session_id = static_cast<std::uint64_t>(channel.session_id.AsInt(message->payload));
    message->tick = static_cast<std::uint64_t>(channel.tick.AsInt(message->payload));
    channel.origin.SetInt(message->payload, kOriginReplay);
    if (channel.last_tick) {
      ++states_played_;
      channel.last_tick->SetInt(message->payload, states_played_ == state_count_ ? 1 : 0);
    }
  } catch (const recording::CdrError& error) {
    throw std::invalid_argument("message " + std::to_string(recorded.sequence) + " of topic '" +
                                published_[channel.topic] + "': " + error.what());
  }
  return true;
}

void Playlist::Retarget(PlayedMessage* message, std::uint64_t session_id, std::uint64_t tick,
                        std::int64_t stamp_ns) const {
  const Channel& channel = *by_topic_[message->topic];
  channel.session_id.SetInt(message->payload, static_cast<std::int64_t>(session_id));
  channel.tick.SetInt(message->payload, static_cast<std::int64_t>(tick));
  channel.stamp_ns.SetInt(message->payload, stamp_ns);
  message->session_id = session_id;
  message->tick = tick;
}

}  // namespace sinew::logger
