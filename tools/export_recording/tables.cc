#include "tools/export_recording/tables.h"

#include <algorithm>

#include "components/base/config/config.h"
#include "components/base/types/did_you_mean.h"
#include "components/record/recording/cdr.h"
#include "components/record/recording/session_clock.h"

namespace sinew::export_recording {
namespace {

using recording::McapChannel;
using recording::McapMessage;

constexpr const char* kTickTopic = "joint_state";

struct Header {
  recording::CdrField session, tick;
};

std::vector<std::string> TopicsOf(const recording::McapReader& reader) {
  std::set<std::string> names;
  for (const auto& [id, channel] : reader.channels()) names.insert(channel.topic);
  return {names.begin(), names.end()};
}

}  // namespace

bool IsInside(const McapMessage& message, const std::optional<recording::TimeRange>& range) {
  if (!range) return true;
  const double time_s = 1e-9 * static_cast<double>(message.publish_time_ns);
  return time_s >= range->start_s && time_s < range->end_s;
}

Tables::Tables(const recording::RecordingPath& path, const std::set<std::string>& topics,
               const std::set<std::string>& also)
    : path_(path), source_(path.file) {
  const std::string file = path_.file.string();
  try {
    reader_ = std::make_unique<recording::McapReader>(source_);
    std::map<std::string, recording::MessageType> known_types;
    std::map<std::string, const recording::McapSchema*> schemas;
    for (const auto& [id, channel] : reader_->channels()) {
      const bool wanted = topics.contains(channel.topic);
      if (!topics.empty() && !wanted && !also.contains(channel.topic)) continue;
      try {
        known_types.emplace(channel.topic, recording::MessageTypeOf(*reader_, channel));
      } catch (const recording::NotReadable& error) {
        if (wanted) throw UsageError(file + ": " + error.what());
        left_out_.emplace(channel.topic, error.what());
        continue;
      }
      const recording::McapSchema* schema = reader_->SchemaOf(channel);
      const auto [known, is_new] = schemas.emplace(channel.topic, schema);
      if (!is_new && (known->second->data != schema->data || known->second->name != schema->name)) {
        throw UsageError(file + ": topic '" + channel.topic +
                         "' was recorded with two types, expected one");
      }
    }
    for (const std::string& topic : topics) {
      if (known_types.contains(topic)) continue;
      throw UsageError(file + ": " + types::NoSuch("topic", topic, TopicsOf(*reader_)));
    }
    for (const auto& [topic, type] : known_types) {
      auto table = std::make_unique<TopicTable>();
      table->topic = topic;
      table->type = type;
      table->columns = std::make_unique<Columns>(*type.type);
      list_.push_back(std::move(table));
    }
  } catch (const recording::McapError& error) {
    throw UsageError(file + ": " + error.what());
  }
  Widen();
  std::erase_if(list_, [](const auto& table) { return table->rows == 0; });
  if (list_.empty()) {
    throw UsageError(file + ": no message" + (path_.range ? " in " + path_.range->text : "") +
                     ", expected some");
  }
}

std::string Tables::cut_off() const {
  return reader_->recovery() ? reader_->recovery()->reason : std::string();
}

void Tables::Widen() {
  std::map<std::size_t, Header> headers;
  for (std::size_t i = 0; i < list_.size(); ++i) {
    const recording::IdlType& type = *list_[i]->type.type;
    if (list_[i]->topic == kTickTopic && recording::HasField(type, "header.tick")) {
      headers.emplace(i, Header{recording::CdrField(type, "header.session_id"),
                                recording::CdrField(type, "header.tick")});
    }
  }
  recording::TickOrder order;
  Read([&](std::size_t table, const McapMessage& message) {
    list_[table]->columns->Widen(message.data);
    ++list_[table]->rows;
    if (const auto header = headers.find(table); header != headers.end()) {
      in_file_order_ |=
          !order.Take(static_cast<std::uint64_t>(header->second.session.AsInt(message.data)),
                      static_cast<std::uint64_t>(header->second.tick.AsInt(message.data)));
    }
  });
}

void Tables::Read(const Take& take, std::optional<std::size_t> only) const {
  std::map<std::string, std::size_t> table_of;
  recording::MessageFilter filter;
  filter.in_file_order = in_file_order_;
  filter.topics.emplace();
  for (std::size_t i = 0; i < list_.size(); ++i) {
    if (only && *only != i) continue;
    table_of[list_[i]->topic] = i;
    filter.topics->insert(list_[i]->topic);
  }
  std::string topic;
  try {
    recording::McapMessages messages = reader_->Messages(filter);
    McapMessage message;
    while (messages.Next(&message)) {
      if (!IsInside(message, path_.range)) continue;
      topic = reader_->channels().at(message.channel_id).topic;
      take(table_of.at(topic), message);
    }
  } catch (const recording::McapError& error) {
    throw UsageError(path_.file.string() + ": " + error.what());
  } catch (const recording::CdrError& error) {
    throw UsageError(path_.file.string() + ": a message of '" + topic + "': " + error.what());
  }
}

}  // namespace sinew::export_recording
