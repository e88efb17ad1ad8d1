#include "components/record/logger/player/playlist.h"

#include <cmath>
#include <regex>
#include <stdexcept>

#include "components/base/types/joined.h"
#include "components/base/types/robot_state.h"
#include "components/record/recording/idl_schema.h"
#include "components/record/recording/session_clock.h"

namespace sinew::logger {

using recording::CdrField;
using recording::IdlSchema;
using recording::IdlType;
using recording::McapChannel;
using recording::McapMessage;
using recording::McapSchema;

namespace {

const std::set<std::string> kNotByDefault = {"component_status", "log", "recording_progress"};

const recording::TopicSchema* Find(const std::vector<recording::TopicSchema>& known,
                                   const std::string& name) {
  for (const recording::TopicSchema& schema : known) {
    if (schema.topic == name) return &schema;
  }
  return nullptr;
}

struct TopicPattern {
  std::string text;
  std::regex expression;
};

std::vector<TopicPattern> Patterns(const std::string& option,
                                   const std::vector<std::string>& texts) {
  std::vector<TopicPattern> patterns;
  for (const std::string& text : texts) {
    try {
      patterns.push_back({text, std::regex(text)});
    } catch (const std::regex_error& error) {
      throw std::invalid_argument(option + ": '" + text + "' is no regular expression (" +
                                  error.what() + ")");
    }
  }
  return patterns;
}

bool MatchesAny(const std::vector<TopicPattern>& patterns, const std::string& topic) {
  return std::any_of(patterns.begin(), patterns.end(), [&](const TopicPattern& pattern) {
    return std::regex_match(topic, pattern.expression);
  });
}

bool Contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

// A topic with several writers has several channels.
void AddOnce(const std::string& name, std::vector<std::string>* names) {
  if (!Contains(*names, name)) names->push_back(name);
}

// Names of the options: each is recorded, and known where it is remapped to.
void CheckNames(const recording::McapReader& reader, const std::string& file,
                const std::vector<recording::TopicSchema>& known,
                const std::vector<TopicPattern>& wanted, const std::vector<TopicPattern>& excluded,
                const std::map<std::string, std::string>& remap) {
  std::set<std::string> recorded;
  for (const auto& [id, channel] : reader.channels()) recorded.insert(channel.topic);
  const auto require = [&](const std::string& option, const std::string& name, bool is_there) {
    if (is_there) return;
    throw std::invalid_argument(option + ": topic '" + name + "' is not in " + file +
                                ", expected one of: " + types::Joined(recorded));
  };
  for (const auto& [option, patterns] :
       {std::pair<std::string, const std::vector<TopicPattern>*>("--topics", &wanted),
        {"--exclude", &excluded}}) {
    for (const TopicPattern& pattern : *patterns) {
      require(option, pattern.text,
              std::any_of(recorded.begin(), recorded.end(), [&](const std::string& name) {
                return std::regex_match(name, pattern.expression);
              }));
    }
  }
  for (const auto& [from, to] : remap) {
    require("--remap", from, recorded.contains(from));
    if (Find(known, to) == nullptr)
      throw std::invalid_argument("--remap: no topic '" + to + "' in this build");
  }
}

void CheckType(const std::string& file, const McapChannel& channel, const McapSchema* theirs,
               const recording::TopicSchema& ours) {
  const bool same = theirs != nullptr && channel.message_encoding == "cdr" &&
                    theirs->encoding == "omgidl" && theirs->name == ours.type_name &&
                    recording::BareIdl(theirs->data) == recording::BareIdl(ours.idl);
  if (!same) {
    const auto hash = channel.metadata.find("idl_hash");
    throw std::invalid_argument(
        file + ": topic '" + channel.topic + "' was recorded with another type (" +
        (theirs == nullptr ? "no schema" : theirs->name) + ", hash " +
        (hash == channel.metadata.end() ? "unknown" : hash->second) + ") than this build's " +
        ours.type_name + " (hash " + ours.idl_hash +
        "): play it with the build that recorded it, or leave the topic out");
  }
}

}  // namespace

// The finalizer of SplitMix64 (Steele, Lea, Flood 2014): passes give unrelated numbers.
std::uint64_t SessionInPass(std::uint64_t recorded, std::uint64_t pass) {
  if (pass == 0) return recorded;
  std::uint64_t mixed = recorded + pass * 0x9E3779B97F4A7C15u;
  mixed = (mixed ^ (mixed >> 30)) * 0xBF58476D1CE4E5B9u;
  mixed = (mixed ^ (mixed >> 27)) * 0x94D049BB133111EBu;
  mixed ^= mixed >> 31;
  return mixed == 0 ? 1 : mixed;
}

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
                   const std::vector<recording::TopicSchema>& known, const PlaylistOptions& options)
    : reader_(reader) {
  const std::vector<TopicPattern> wanted = Patterns("--topics", options.topics);
  const std::vector<TopicPattern> excluded = Patterns("--exclude", options.exclude);
  CheckNames(reader, file, known, wanted, excluded, options.remap);
  filter_.topics.emplace();
  for (const auto& [id, channel] : reader.channels()) {
    const bool named = Contains(options.topics, channel.topic);
    const bool matched = wanted.empty() || MatchesAny(wanted, channel.topic);
    if (!matched || MatchesAny(excluded, channel.topic)) continue;
    if (!named && kNotByDefault.contains(channel.topic)) continue;
    if (!named && Contains(options.only_when_named, channel.topic)) {
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
    if (!named && !IsReadable(reader, channel, &not_readable_)) continue;
    CheckType(file, channel, theirs, *ours);
    std::size_t index = 0;
    while (index < published_.size() && published_[index] != name) ++index;
    auto made = std::make_unique<Channel>(*theirs, index);
    if (name == "joint_state") made->last_tick.emplace(made->type, "last_tick");
    if (index == published_.size()) {
      published_.push_back(name);
      by_topic_.push_back(made.get());
    }
    channels_[id] = std::move(made);
    filter_.topics->insert(channel.topic);
    if (Contains(options.latched, name)) latched_.insert(channel.topic);
  }

  if (channels_.empty()) {
    throw std::invalid_argument(
        (not_readable_.empty() ? file : recording::LeftOutText(file, not_readable_)) +
        ": no topic to play" +
        (not_named_.empty() ? ""
                            : "; those in it command, and are played when --topics names them"));
  }
  const recording::McapStatistics& statistics = reader.statistics();
  const auto offset = [&statistics](double seconds) {
    const double ns = std::min(seconds * 1e9, 9e18 - static_cast<double>(statistics.start_time_ns));
    return statistics.start_time_ns + static_cast<std::int64_t>(std::llround(ns));
  };
  filter_.start_ns = offset(options.start_s);
  filter_.end_ns = offset(options.end_s);
  const std::int64_t last_ns = CountMessages();
  if (options.start_s > 0.0) earlier_ = NewestBefore(filter_.start_ns);
  if (message_count_ == 0 && earlier_.empty())
    throw std::invalid_argument(file + ": no message between the start and end asked for");
  duration_ns_ = last_ns - first_ns_;
  message_count_ += earlier_.size();
  messages_.emplace(reader.Messages(filter_));
}

Playlist::~Playlist() = default;

std::int64_t Playlist::CountMessages() {
  recording::McapMessages messages = reader_.Messages(filter_);
  McapMessage message;
  std::int64_t last_ns = 0;
  recording::TickOrder order;
  while (messages.Next(&message)) {
    if (message_count_ == 0) first_ns_ = message.log_time_ns;
    last_ns = message.log_time_ns;
    ++message_count_;
    const Channel& channel = *channels_.at(message.channel_id);
    if (!channel.last_tick) continue;
    last_state_ = Place{message.channel_id, message.log_time_ns, message.sequence};
    filter_.in_file_order |=
        !order.Take(static_cast<std::uint64_t>(channel.session_id.AsInt(message.data)),
                    static_cast<std::uint64_t>(channel.tick.AsInt(message.data)));
  }
  if (filter_.in_file_order) ReadPlaces(&last_ns);
  return last_ns;
}

void Playlist::ReadPlaces(std::int64_t* last_ns) {
  recording::McapMessages messages = reader_.Messages(filter_);
  McapMessage message;
  RisingTime time;
  bool is_first = true;
  while (messages.Next(&message)) {
    *last_ns = time.Take(message.log_time_ns);
    if (is_first) first_ns_ = *last_ns;
    is_first = false;
    if (channels_.at(message.channel_id)->last_tick) {
      last_state_ = Place{message.channel_id, message.log_time_ns, message.sequence};
    }
  }
}

std::deque<Playlist::Latched> Playlist::NewestBefore(std::int64_t time_ns) const {
  std::map<recording::ChannelId, Latched> newest;
  if (!latched_.empty()) {
    recording::MessageFilter before;
    before.topics = latched_;
    before.end_ns = time_ns - 1;
    recording::McapMessages messages = reader_.Messages(before);
    McapMessage message;
    while (messages.Next(&message)) {
      newest[message.channel_id] = {message.channel_id,
                                    message.log_time_ns,
                                    message.sequence,
                                    {message.data.begin(), message.data.end()}};
    }
  }
  std::deque<Latched> out;
  for (auto& [id, sample] : newest) out.push_back(std::move(sample));
  std::stable_sort(out.begin(), out.end(), [](const Latched& a, const Latched& b) {
    return a.log_time_ns < b.log_time_ns;
  });
  return out;
}

bool Playlist::Next(PlayedMessage* message) {
  if (!earlier_.empty()) {
    const Latched sample = std::move(earlier_.front());
    earlier_.pop_front();
    message->payload = sample.data;
    message->due_ns = begin_ns_;
    Fill(sample.channel, sample.sequence, sample.log_time_ns, message);
    return true;
  }
  McapMessage recorded;
  do {
    if (!messages_->Next(&recorded)) return false;
    message->due_ns = time_.Take(recorded.log_time_ns) - first_ns_;
    if (message->due_ns < begin_ns_) continue;  // in file order
    if (channels_.at(recorded.channel_id)->last_tick) before_state_ = false;
  } while (before_state_ || message->due_ns < begin_ns_);
  message->payload.assign(recorded.data.begin(), recorded.data.end());
  Fill(recorded.channel_id, recorded.sequence, recorded.log_time_ns, message);
  return true;
}

void Playlist::Fill(recording::ChannelId id, std::uint32_t sequence, std::int64_t log_time_ns,
                    PlayedMessage* message) const {
  const Channel& channel = *channels_.at(id);
  message->topic = channel.topic;
  message->is_state = channel.last_tick.has_value();
  try {
    message->session_id = static_cast<std::uint64_t>(channel.session_id.AsInt(message->payload));
    message->tick = static_cast<std::uint64_t>(channel.tick.AsInt(message->payload));
    channel.origin.SetInt(message->payload, static_cast<std::int64_t>(types::Origin::kReplay));
    if (pass_ > 0) {
      message->session_id = SessionInPass(message->session_id, pass_);
      channel.session_id.SetInt(message->payload, static_cast<std::int64_t>(message->session_id));
    }
    if (channel.last_tick) {
      const Place place{id, log_time_ns, sequence};
      channel.last_tick->SetInt(message->payload, last_pass_ && last_state_ == place ? 1 : 0);
    }
  } catch (const recording::CdrError& error) {
    throw std::invalid_argument("message " + std::to_string(sequence) + " of topic '" +
                                published_[channel.topic] + "': " + error.what());
  }
}

void Playlist::BeginPass(std::uint64_t pass, std::int64_t position_ns, bool last_pass) {
  pass_ = pass;
  last_pass_ = last_pass;
  before_state_ = last_state_.has_value() && position_ns > 0;
  begin_ns_ = std::clamp<std::int64_t>(position_ns, 0, duration_ns_);
  time_ = RisingTime();
  recording::MessageFilter from = filter_;
  if (!filter_.in_file_order) from.start_ns = first_ns_ + begin_ns_;
  earlier_ = NewestBefore(first_ns_ + begin_ns_);
  messages_.emplace(reader_.Messages(from));
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
