#include "tools/view/recorded_view.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <charconv>
#include <initializer_list>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "components/base/config/config.h"
#include "components/base/types/json_text.h"
#include "components/base/types/seconds.h"
#include "tools/view/shown_log.h"

namespace sinew::live {

namespace {

constexpr const char* kTickTopic = "joint_state";
constexpr const char* kStatusTopic = "component_status";
constexpr const char* kLogTopic = "log";
// By how much a message may be received after the joint_state of its tick: a second is as long as
// the rarest topic of a cycle, component_status, waits.
constexpr std::int64_t kLogMargin_ns = 1'000'000'000;

template <class Value>
void AppendLittleEndian(Value value, std::string* out) {
  for (std::size_t i = 0; i < sizeof value; ++i) {
    out->push_back(static_cast<char>((value >> (8 * i)) & 0xff));
  }
}

using QueryValues = std::map<std::string, std::string>;

QueryValues ValuesOf(const std::string& query, std::initializer_list<const char*> required,
                     const char* form) {
  QueryValues values;
  std::istringstream parts(query);
  for (std::string part; std::getline(parts, part, '&');) {
    const std::size_t equals = part.find('=');
    if (equals != std::string::npos) values[part.substr(0, equals)] = part.substr(equals + 1);
  }
  for (const char* key : required) {
    if (!values.contains(key)) {
      throw UsageError(std::string("no ") + key + ", expected " + form);
    }
  }
  return values;
}

template <class Whole>
Whole ToWhole(const QueryValues& values, const std::string& key, const char* expected) {
  const std::string& text = values.at(key);
  Whole value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) {
    throw UsageError(key + "=" + text + ": expected " + expected);
  }
  return value;
}

std::int64_t ToStamp(const QueryValues& values, const std::string& key) {
  return ToWhole<std::int64_t>(values, key, "whole nanoseconds");
}

std::size_t ToSession(const QueryValues& values) {
  if (!values.contains("session")) return 1;
  return ToWhole<std::size_t>(values, "session", "the number of a session, from 1 on");
}

}  // namespace

RecordedView::Query ParseQuery(const std::string& query) {
  const QueryValues values = ValuesOf(query, {"topics", "from_ns", "to_ns"},
                                      "topics=A,B&from_ns=N&to_ns=N, and session=N for another "
                                      "session than the first");
  RecordedView::Query out;
  out.session = ToSession(values);
  std::istringstream names(values.at("topics"));
  for (std::string name; std::getline(names, name, ',');) out.topics.push_back(name);
  out.from_ns = ToStamp(values, "from_ns");
  out.to_ns = ToStamp(values, "to_ns");
  return out;
}

RecordedView::Moment ParseMoment(const std::string& query) {
  const QueryValues values =
      ValuesOf(query, {"at_ns"}, "at_ns=N, and session=N for another session than the first");
  return {ToSession(values), ToStamp(values, "at_ns")};
}

RecordedView::RecordedView(const std::filesystem::path& file) try
    : file_(file.string()), source_(file), reader_(source_) {
  const auto& counts = reader_.statistics().channel_message_counts;
  recording::LeftOut left_out;
  for (const auto& [id, channel] : reader_.channels()) {
    const auto count = counts.find(id);
    try {
      AddChannel(id, channel, count == counts.end() ? 0 : count->second);
    } catch (const recording::NotReadable& error) {
      left_out.emplace(channel.topic, error.what());
    }
  }
  if (!left_out.empty()) spdlog::warn("{}", recording::LeftOutText(file_, left_out));
  recording::MessageFilter filter;
  filter.topics = std::set<std::string>{kTickTopic, kStatusTopic, kLogTopic};
  recording::McapMessages messages = reader_.Messages(filter);
  recording::McapMessage message;
  while (messages.Next(&message)) {
    const auto reader = readers_.find(message.channel_id);
    if (reader == readers_.end()) continue;
    if (topics_[reader->second.index].topic == kTickTopic) {
      AddTick(reader->second, message);
    } else if (reader->second.log) {
      AddLine(reader->second, message);
    } else if (reader->second.status) {
      AddStatus(reader->second, message);
    }
  }
  EndTicks();
  if (sessions_.empty()) {
    throw UsageError(file_ + ": no " + kTickTopic + ", expected a recording of a robot");
  }
} catch (const recording::McapError& error) {
  throw UsageError(file.string() + ": " + error.what());
} catch (const recording::CdrError& error) {
  throw UsageError(file.string() + ": a message of joint_state: " + error.what());
}

void RecordedView::AddChannel(recording::ChannelId id, const recording::McapChannel& channel,
                              std::uint64_t messages) {
  const recording::MessageType readable = recording::MessageTypeOf(reader_, channel);
  const recording::McapSchema* schema = reader_.SchemaOf(channel);
  const recording::IdlType& type = *readable.type;
  for (const char* field : {"header.session_id", "header.tick", "header.stamp_ns"}) {
    if (recording::HasField(type, field)) continue;
    throw recording::NotReadable("topic '" + channel.topic + "' has messages without " + field);
  }
  std::optional<StatusReader> status;
  try {
    if (channel.topic == kStatusTopic) status.emplace(type);
  } catch (const recording::CdrError& error) {
    throw recording::NotReadable("topic '" + channel.topic + "' has another type: " + error.what());
  }
  auto topic = std::find_if(topics_.begin(), topics_.end(), [&](const RecordedTopic& other) {
    return other.topic == channel.topic && other.schema == schema->data;
  });
  if (topic == topics_.end()) {
    topic = topics_.insert(topic, {channel.topic, schema->name, schema->data, 0});
  }
  topic->messages += messages;
  Reader reader{static_cast<std::size_t>(topic - topics_.begin()),
                readable,
                recording::CdrField(type, "header.session_id"),
                recording::CdrField(type, "header.tick"),
                recording::CdrField(type, "header.stamp_ns"),
                std::move(status),
                std::nullopt};
  if (channel.topic == kLogTopic && recording::HasField(type, "time_ns")) reader.log.emplace(type);
  readers_.emplace(id, std::move(reader));
}

void RecordedView::AddTick(const Reader& reader, const recording::McapMessage& message) {
  const auto id = static_cast<std::uint64_t>(reader.session.AsInt(message.data));
  const std::int64_t stamp_ns = reader.stamp.AsInt(message.data);
  const auto tick = static_cast<std::uint64_t>(reader.tick.AsInt(message.data));
  // The newest first: a session that has ended has no later tick.
  const auto found = std::find_if(sessions_.rbegin(), sessions_.rend(),
                                  [id](const RecordedSession& other) { return other.id == id; });
  auto index = static_cast<std::size_t>(sessions_.rend() - found);
  if (found == sessions_.rend()) {
    sessions_.push_back({.id = id});
    ticks_.emplace_back();
    index = sessions_.size();
  }
  ticks_[index - 1].push_back({tick, stamp_ns, message.log_time_ns});
}

// Ticks in their order, and their times: a clock that was set back leaves neither out.
void RecordedView::EndTicks() {
  times_.resize(sessions_.size());
  clocks_.resize(sessions_.size());
  for (std::size_t i = 0; i < sessions_.size(); ++i) {
    std::stable_sort(ticks_[i].begin(), ticks_[i].end(),
                     [](const Tick& a, const Tick& b) { return a.tick < b.tick; });
    for (const Tick& tick : ticks_[i]) {
      const std::int64_t time_ns = clocks_[i].Take(tick.tick, tick.stamp_ns);
      if (!times_[i].empty() && time_ns <= times_[i].back().stamp_ns) continue;
      times_[i].push_back({time_ns, tick.log_ns});
    }
    sessions_[i].start_ns = times_[i].front().stamp_ns;
    sessions_[i].end_ns = times_[i].back().stamp_ns;
    sessions_[i].ticks = times_[i].size();
    if (clocks_[i].set_back_ns() > 0) {
      spdlog::warn("session {}: the clock was set back by {} s; time goes on", i + 1,
                   types::SecondsText(1e-9 * static_cast<double>(clocks_[i].set_back_ns())));
    }
  }
  ticks_.clear();
}

void RecordedView::AddStatus(const Reader& reader, const recording::McapMessage& message) {
  try {
    participants_.Add(message.log_time_ns, reader.status->Read(message.data));
  } catch (const recording::CdrError&) {
    // A recorder keeps malformed messages as they came; nobody is shown by them.
  }
}

void RecordedView::AddLine(const Reader& reader, const recording::McapMessage& message) {
  try {
    lines_.push_back({message.log_time_ns, reader.log->Read(message.data)});
  } catch (const recording::CdrError&) {
    // As malformed statuses.
  }
}

std::string RecordedView::Description() const {
  nlohmann::ordered_json sessions = nlohmann::ordered_json::array();
  for (const RecordedSession& session : sessions_) {
    sessions.push_back({{"session", sessions.size() + 1},
                        {"session_id", std::to_string(session.id)},
                        {"start_ns", std::to_string(session.start_ns)},
                        {"end_ns", std::to_string(session.end_ns)},
                        {"length_s", static_cast<double>(session.end_ns - session.start_ns) / 1e9},
                        {"ticks", session.ticks}});
  }
  nlohmann::ordered_json topics = nlohmann::ordered_json::array();
  for (const RecordedTopic& topic : topics_) {
    topics.push_back({{"topic", topic.topic},
                      {"schemaName", topic.schema_name},
                      {"schema", topic.schema},
                      {"messages", topic.messages}});
  }
  return types::JsonText(nlohmann::ordered_json{
      {"file", file_}, {"sessions", std::move(sessions)}, {"topics", std::move(topics)}});
}

std::size_t RecordedView::IndexOf(std::size_t session) const {
  if (session < 1 || session > sessions_.size()) {
    throw UsageError("session=" + std::to_string(session) + ": expected 1 to " +
                     std::to_string(sessions_.size()));
  }
  return session - 1;
}

std::int64_t RecordedView::LogTime(std::size_t index, std::int64_t stamp_ns) const {
  const std::vector<Times>& times = times_[index];
  const auto found =
      std::lower_bound(times.begin(), times.end(), stamp_ns,
                       [](const Times& at, std::int64_t value) { return at.stamp_ns < value; });
  return found == times.end() ? times.back().log_ns : found->log_ns;
}

std::pair<std::int64_t, std::int64_t> RecordedView::LogTimes(std::size_t index,
                                                             const Query& query) const {
  std::int64_t first_ns = LogTime(index, query.from_ns), last_ns = LogTime(index, query.to_ns);
  if (clocks_[index].set_back_ns() > 0) {
    for (const Times& at : times_[index]) {
      if (at.stamp_ns < query.from_ns || at.stamp_ns > query.to_ns) continue;
      first_ns = std::min(first_ns, at.log_ns);
      last_ns = std::max(last_ns, at.log_ns);
    }
  }
  return {first_ns, last_ns};
}

std::string RecordedView::Messages(const Query& query) const {
  const std::size_t index = IndexOf(query.session);
  const std::uint64_t id = sessions_[index].id;
  recording::MessageFilter filter;
  filter.topics = std::set<std::string>(query.topics.begin(), query.topics.end());
  const auto [first_ns, last_ns] = LogTimes(index, query);
  filter.start_ns = std::max<std::int64_t>(first_ns - kLogMargin_ns, 0);
  filter.end_ns = last_ns + kLogMargin_ns;
  filter.in_file_order = clocks_[index].set_back_ns() > 0;
  recording::McapMessages messages = reader_.Messages(filter);
  recording::McapMessage message;
  std::string out;
  try {
    while (messages.Next(&message)) {
      const auto found = readers_.find(message.channel_id);
      if (found == readers_.end()) continue;
      const Reader& reader = found->second;
      if (static_cast<std::uint64_t>(reader.session.AsInt(message.data)) != id) continue;
      const std::int64_t stamp_ns =
          reader.stamp.AsInt(message.data) +
          clocks_[index].ShiftOf(static_cast<std::uint64_t>(reader.tick.AsInt(message.data)));
      if (stamp_ns < query.from_ns || stamp_ns > query.to_ns) continue;
      AppendLittleEndian(static_cast<std::uint16_t>(reader.index), &out);
      AppendLittleEndian(static_cast<std::uint64_t>(stamp_ns), &out);
      AppendLittleEndian(static_cast<std::uint32_t>(message.data.size()), &out);
      out.append(reinterpret_cast<const char*>(message.data.data()), message.data.size());
      if (out.size() > kMostBytes) {
        throw UsageError("more than " + std::to_string(kMostBytes >> 20) +
                         " MiB, expected a shorter time or fewer topics");
      }
    }
  } catch (const recording::McapError& error) {
    throw UsageError(file_ + ": " + error.what());
  } catch (const recording::CdrError& error) {
    throw UsageError(file_ + ": a message that does not fit its schema: " + error.what());
  }
  return out;
}

std::string RecordedView::ParticipantsAt(const Moment& moment) const {
  const std::size_t index = IndexOf(moment.session);
  return types::JsonText(participants_.Rows(LogTime(index, moment.at_ns)));
}

std::string RecordedView::LogAt(const Moment& moment) const {
  const std::size_t index = IndexOf(moment.session);
  const std::vector<Times>& times = times_[index];
  const auto after = [](std::int64_t log_ns, const Line& line) { return log_ns < line.log_ns; };
  // At the end with what its participants said when it was over.
  std::int64_t end_ns = LogTime(index, moment.at_ns);
  if (moment.at_ns >= times.back().stamp_ns) {
    end_ns = index + 1 < times_.size() ? times_[index + 1].front().log_ns
                                       : std::numeric_limits<std::int64_t>::max();
  }
  const auto end = std::upper_bound(lines_.begin(), lines_.end(), end_ns, after);
  const auto first =
      index == 0 ? lines_.begin()
                 : std::upper_bound(lines_.begin(), end, times_[index - 1].back().log_ns, after);
  const auto most = static_cast<std::ptrdiff_t>(ShownLog::kMost);
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (auto line = end - std::min(end - first, most); line != end; ++line) {
    const auto tick =
        std::lower_bound(times.begin(), times.end(), line->log_ns,
                         [](const Times& at, std::int64_t value) { return at.log_ns < value; });
    const Times& at = tick == times.end() ? times.back() : *tick;
    rows.push_back(LogRow(line->line));
    rows.back()["time_s"] = 1e-9 * static_cast<double>(at.stamp_ns - times.front().stamp_ns);
  }
  return types::JsonText(rows);
}

}  // namespace sinew::live
