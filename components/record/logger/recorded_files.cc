#include "components/record/logger/recorded_files.h"

#include <algorithm>
#include <utility>

namespace sinew::logger {

using recording::IoStatus;
using recording::McapMetadata;

namespace {

constexpr std::chrono::seconds kLossesSpan(10);
constexpr std::size_t kChunkBytes = 1u << 20;

std::string GuidText(const WriterGuid& guid) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : guid) {
    text += kDigits[byte >> 4];
    text += kDigits[byte & 15];
  }
  return text;
}

}  // namespace

RecordedFiles::RecordedFiles(RecordingSink& sink, std::vector<recording::TopicSchema> topics,
                             std::vector<McapMetadata> metadata, FilesOptions options)
    : sink_(sink),
      topics_(std::move(topics)),
      metadata_(std::move(metadata)),
      options_(std::move(options)),
      latched_(options_.repeats),
      losses_(topics_.size()) {}

std::uint64_t RecordedFiles::bytes() const {
  return bytes_before_ + (writer_ ? writer_->bytes_written() : 0);
}

IoStatus RecordedFiles::Begin(const std::vector<McapMetadata>& more) {
  const int number = next_number_++;
  if (IoStatus status = sink_.Begin(number); !status.ok()) return status;
  writer_.emplace(sink_, recording::McapWriterOptions{
                             "sinew", options_.compression,
                             std::chrono::nanoseconds(options_.chunk_span).count(), kChunkBytes});
  channels_.assign(topics_.size(), {});
  first_ns_.reset();
  chunk_since_.reset();
  chunks_seen_ = 0;
  bytes_synced_ = 0;
  written_losses_ = losses_;

  IoStatus status = writer_->Open();
  for (const auto* list : {&metadata_, &more}) {
    for (const McapMetadata& metadata : *list) {
      if (status.ok()) status = writer_->WriteMetadata(metadata);
    }
  }
  if (status.ok() && (options_.split_bytes > 0 || options_.split_span.count() > 0)) {
    status = writer_->WriteMetadata({"sinew.split", {{"number", std::to_string(number)}}});
  }
  for (const recording::McapAttachment& attachment : options_.attachments) {
    if (status.ok()) status = writer_->WriteAttachment(attachment);
  }
  for (std::size_t i = 0; status.ok() && i < topics_.size(); ++i) {
    status =
        writer_->AddSchema(topics_[i].type_name, "omgidl", topics_[i].idl, &channels_[i].schema);
  }
  return status;
}

bool RecordedFiles::SplitIsDue(const RecordedMessage& message) const {
  if (!first_ns_) return false;  // no file without messages
  return (options_.split_bytes > 0 && writer_->bytes_written() >= options_.split_bytes) ||
         (options_.split_span.count() > 0 &&
          message.reception_ns - *first_ns_ >= options_.split_span.count());
}

IoStatus RecordedFiles::AddChannel(const RecordedMessage& message, recording::TextMap writer,
                                   recording::ChannelId* id) {
  const recording::TopicSchema& topic = topics_[message.topic];
  recording::TextMap metadata = {{"idl_hash", topic.idl_hash}};
  if (message.origin.writer != WriterGuid{}) {
    metadata["writer_guid"] = GuidText(message.origin.writer);
    metadata.merge(writer);
  }
  IoStatus status =
      writer_->AddChannel(channels_[message.topic].schema, topic.topic, "cdr", metadata, id);
  if (status.ok()) channels_[message.topic].by_writer.emplace(message.origin.writer, *id);
  return status;
}

IoStatus RecordedFiles::WriteTo(recording::ChannelId channel, const RecordedMessage& message,
                                std::int64_t log_time_ns) {
  // 32 bits of the format, of which a writer at 1 kHz needs 49 days.
  std::optional<std::uint32_t> sequence;
  if (message.origin.sequence > 0) {
    sequence = static_cast<std::uint32_t>(message.origin.sequence);
  }
  return writer_->WriteMessage(channel, std::max<std::int64_t>(log_time_ns, 0),
                               std::max<std::int64_t>(message.stamp_ns, 0), message.payload,
                               sequence);
}

IoStatus RecordedFiles::WriteRepeated(std::int64_t log_time_ns) {
  const std::vector<const LatchedSample*> samples = latched_.Now(options_.writer_is_live);
  if (samples.empty()) return IoStatus::Ok();
  IoStatus status =
      writer_->WriteMetadata({"sinew.repeated", {{"messages", std::to_string(samples.size())}}});
  for (const LatchedSample* sample : samples) {
    const RecordedMessage& message = sample->message;
    const auto& by_writer = channels_[message.topic].by_writer;
    const auto known = by_writer.find(message.origin.writer);
    recording::ChannelId channel{};
    if (known != by_writer.end()) {
      channel = known->second;
    } else if (status.ok()) {
      status = AddChannel(message, sample->writer, &channel);
    }
    if (status.ok()) status = WriteTo(channel, message, log_time_ns);
  }
  return status;
}

void RecordedFiles::Pass(const RecordedMessage& message) {
  latched_.Keep(message, options_.describe_writer);
}

IoStatus RecordedFiles::Write(const RecordedMessage& message) {
  if (SplitIsDue(message)) {
    if (IoStatus status = End(); !status.ok()) return status;
    if (IoStatus status = Begin(); !status.ok()) return status;
  }
  if (!first_ns_) {
    first_ns_ = message.reception_ns;
    if (IoStatus status = WriteRepeated(*first_ns_); !status.ok()) return status;
  }
  const auto& by_writer = channels_[message.topic].by_writer;
  recording::ChannelId channel{};
  if (const auto known = by_writer.find(message.origin.writer); known != by_writer.end()) {
    channel = known->second;
  } else {
    recording::TextMap writer;
    if (options_.describe_writer && message.origin.writer != WriterGuid{}) {
      writer = options_.describe_writer(message.origin.writer);
    }
    if (IoStatus status = AddChannel(message, std::move(writer), &channel); !status.ok()) {
      return status;
    }
  }
  ++messages_;
  Pass(message);
  return WriteTo(channel, message, message.reception_ns);
}

IoStatus RecordedFiles::Tend(Instant now) {
  if (!writer_) return IoStatus::Ok();
  const std::uint64_t chunks = writer_->statistics().chunk_count;
  if (!writer_->chunk_is_open()) {
    chunk_since_.reset();
  } else if (!chunk_since_ || chunks != chunks_seen_) {
    chunk_since_ = now;
    chunks_seen_ = chunks;
  } else if (now - *chunk_since_ >= options_.chunk_span) {
    chunk_since_.reset();
    if (IoStatus status = writer_->CloseChunk(); !status.ok()) return status;
  }
  if (now - last_losses_ >= kLossesSpan && losses_ != written_losses_) {
    last_losses_ = now;
    if (IoStatus status = WriteLosses(); !status.ok()) return status;
  }
  if (options_.sync_span.count() > 0 && now - last_sync_ >= options_.sync_span &&
      writer_->bytes_written() != bytes_synced_) {
    last_sync_ = now;
    bytes_synced_ = writer_->bytes_written();
    return sink_.Sync();
  }
  return IoStatus::Ok();
}

IoStatus RecordedFiles::WriteLosses() {
  written_losses_ = losses_;
  McapMetadata metadata{"sinew.losses", {}};
  TopicLosses total;
  const auto note = [&metadata](const std::string& of, const TopicLosses& losses, bool zeros) {
    for (const auto& [what, count] :
         {std::pair{"lost", losses.lost}, std::pair{"missing", losses.missing},
          std::pair{"dropped", losses.dropped}, std::pair{"malformed", losses.malformed}}) {
      if (count > 0 || zeros) metadata.values[of + "." + what] = std::to_string(count);
    }
  };
  for (std::size_t i = 0; i < losses_.size(); ++i) {
    note(topics_[i].topic, losses_[i], false);
    total.lost += losses_[i].lost;
    total.missing += losses_[i].missing;
    total.dropped += losses_[i].dropped;
    total.malformed += losses_[i].malformed;
  }
  note("all", total, true);
  return writer_->WriteMetadata(metadata);
}

IoStatus RecordedFiles::End() {
  if (!writer_) return IoStatus::Ok();
  IoStatus status = WriteLosses();
  if (status.ok()) status = writer_->Close();
  bytes_before_ += writer_->bytes_written();
  writer_.reset();
  if (!status.ok()) return status;
  return sink_.End();
}

}  // namespace sinew::logger
