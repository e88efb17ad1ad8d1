#include "tools/view/recorded_view.h"

#include <algorithm>
#include <charconv>
#include <set>
#include <sstream>

#include "components/config/config.h"

namespace sinew::live {

namespace {

constexpr const char* kTickTopic = "joint_state";
// By how much a message may be received after the joint_state of its tick: a second is as long as
// the rarest topic of a cycle, component_status, waits.
constexpr std::int64_t kLogMargin_ns = 1'000'000'000;

template <class Value>
void AppendLittleEndian(Value value, std::string* out) {
  for (std::size_t i = 0; i < sizeof value; ++i) {
    out->push_back(static_cast<char>((value >> (8 * i)) & 0xff));
  }
}

std::int64_t ToStamp(const std::string& key, const std::string& text) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) {
    throw UsageError(key + "=" + text + ": expected whole nanoseconds");
  }
  return value;
}

}  // namespace

RecordedView::Query ParseQuery(const std::string& query) {
  std::map<std::string, std::string> values;
  std::istringstream parts(query);
  for (std::string part; std::getline(parts, part, '&');) {
    const std::size_t equals = part.find('=');
    if (equals != std::string::npos) values[part.substr(0, equals)] = part.substr(equals + 1);
  }
  for (const char* key : {"topics", "from_ns", "to_ns"}) {
    if (!values.contains(key)) {
      throw UsageError(std::string("no ") + key + ", expected topics=A,B&from_ns=N&to_ns=N");
    }
  }
  RecordedView::Query out;
  std::istringstream names(values["topics"]);
  for (std::string name; std::getline(names, name, ',');) out.topics.push_back(name);
  out.from_ns = ToStamp("from_ns", values["from_ns"]);
  out.to_ns = ToStamp("to_ns", values["to_ns"]);
  return out;
}

RecordedView::RecordedView(const std::filesystem::path& file) try
    : file_(file.string()), source_(file), reader_(source_) {
  const auto& counts = reader_.statistics().channel_message_counts;
  for (const auto& [id, channel] : reader_.channels()) {
    const recording::McapSchema* schema = reader_.SchemaOf(channel);
    if (schema == nullptr || schema->encoding != "omgidl" || channel.message_encoding != "cdr") {
      continue;
    }
    auto idl = std::make_unique<recording::IdlSchema>(recording::IdlSchema::Parse(schema->data));
    const recording::IdlType& type = idl->Struct(schema->name);
    if (!recording::HasField(type, "header.session_id")) continue;
    recording::CdrField session(type, "header.session_id"), stamp(type, "header.stamp_ns");
    readers_.emplace(id,
                     Reader{topics_.size(), std::move(idl), std::move(session), std::move(stamp)});
    const auto count = counts.find(id);
    topics_.push_back(
        {channel.topic, schema->name, schema->data, count == counts.end() ? 0 : count->second});
  }
  recording::MessageFilter filter;
  filter.topics = std::set<std::string>{kTickTopic};
  recording::McapMessages messages = reader_.Messages(filter);
  recording::McapMessage message;
  while (messages.Next(&message)) {
    const auto reader = readers_.find(message.channel_id);
    if (reader == readers_.end()) continue;
    const std::int64_t session = reader->second.session.AsInt(message.data);
    if (times_.empty()) session_ = session;
    const std::int64_t stamp_ns = reader->second.stamp.AsInt(message.data);
    if (session != session_) {
      more_sessions_ = true;
    } else if (times_.empty() || stamp_ns > times_.back().stamp_ns) {
      times_.push_back({stamp_ns, message.log_time_ns});
    }
  }
  if (times_.empty()) {
    throw UsageError(file_ + ": no " + kTickTopic + ", expected a recording of a robot");
  }
} catch (const recording::McapError& error) {
  throw UsageError(file.string() + ": " + error.what());
} catch (const recording::IdlError& error) {
  throw UsageError(file.string() + ": a schema: " + error.what());
} catch (const recording::CdrError& error) {
  throw UsageError(file.string() + ": a message of joint_state: " + error.what());
}

std::string RecordedView::Messages(const Query& query) const {
  const auto log_at = [this](std::int64_t stamp_ns) {
    const auto found = std::lower_bound(
        times_.begin(), times_.end(), stamp_ns,
        [](const Times& times, std::int64_t value) { return times.stamp_ns < value; });
    return found == times_.end() ? times_.back().log_ns : found->log_ns;
  };
  recording::MessageFilter filter;
  filter.topics = std::set<std::string>(query.topics.begin(), query.topics.end());
  filter.start_ns = std::max<std::int64_t>(log_at(query.from_ns) - kLogMargin_ns, 0);
  filter.end_ns = log_at(query.to_ns) + kLogMargin_ns;
  recording::McapMessages messages = reader_.Messages(filter);
  recording::McapMessage message;
  std::string out;
  try {
    while (messages.Next(&message)) {
      const auto found = readers_.find(message.channel_id);
      if (found == readers_.end()) continue;
      const Reader& reader = found->second;
      if (reader.session.AsInt(message.data) != session_) continue;
      const std::int64_t stamp_ns = reader.stamp.AsInt(message.data);
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

}  // namespace sinew::live
