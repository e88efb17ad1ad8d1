#include "components/record/recording/mcap_writer.h"

#include <algorithm>
#include <concepts>
#include <limits>
#include <type_traits>

#include "components/base/types/printable.h"
#include "components/record/recording/mcap_fields.h"

namespace sinew::recording {
namespace {

// Starts a record; FinishRecord fills in its length.
std::size_t StartRecord(Bytes* out, Opcode opcode) {
  Put(out, static_cast<std::uint8_t>(opcode));
  Put(out, std::uint64_t{0});
  return out->size();
}

void FinishRecord(Bytes* out, std::size_t content_start) {
  PutAt(out, content_start - 8, static_cast<std::uint64_t>(out->size() - content_start));
}

// Fields to the end of the bytes.
class FieldWriter {
 public:
  explicit FieldWriter(Bytes* out) : out_(out) {}

  template <class... Field>
  void operator()(const Field&... fields) {
    (Write(fields), ...);
  }

 private:
  template <std::unsigned_integral Number>
  void Write(Number number) {
    Put(out_, number);
  }
  template <class Id>
  requires std::is_enum_v<Id>
  void Write(Id id) { Put(out_, static_cast<std::underlying_type_t<Id>>(id)); }
  void Write(std::int64_t time_ns) { Put(out_, static_cast<std::uint64_t>(time_ns)); }
  void Write(UnusedTime) { Put(out_, std::uint64_t{0}); }
  // Texts of the format are UTF-8, names of files any bytes.
  void Write(const std::string& text) { PutText(out_, types::Utf8(text)); }
  void Write(Verbatim<const std::string> field) { PutText(out_, field.text); }
  void Write(LongText<const std::string> field) {
    Put(out_, static_cast<std::uint64_t>(field.text.size()));
    PutRaw(out_, field.text);
  }
  void Write(std::span<const std::byte> data) {
    out_->insert(out_->end(), data.begin(), data.end());
  }
  void Write(const TextMap& map) {
    const std::size_t start = out_->size();
    Put(out_, std::uint32_t{0});
    for (const auto& [key, value] : map) (*this)(key, value);
    PutAt(out_, start, static_cast<std::uint32_t>(out_->size() - start - 4));
  }
  void Write(const std::map<ChannelId, std::uint64_t>& by_channel) {
    Put(out_, static_cast<std::uint32_t>(10 * by_channel.size()));
    for (const auto& [channel, value] : by_channel) (*this)(channel, value);
  }

  Bytes* out_;
};

template <class Record>
void PutRecord(Bytes* out, const Record& record) {
  const std::size_t start = StartRecord(out, Record::kOpcode);
  VisitFields(FieldWriter(out), record);
  FinishRecord(out, start);
}

}  // namespace

McapWriter::McapWriter(ByteSink& sink, McapWriterOptions options)
    : sink_(sink), options_(std::move(options)) {}

IoStatus McapWriter::Emit(const Bytes& bytes) {
  if (!status_.ok()) return status_;
  status_ = sink_.Write(bytes);
  if (status_.ok()) {
    offset_ += bytes.size();
    data_crc_.process_bytes(bytes.data(), bytes.size());
  }
  return status_;
}

IoStatus McapWriter::Open() { return Open(""); }

IoStatus McapWriter::Open(const std::string& profile) {
  if (open_) return IoStatus::Failed("the file is open already");
  Bytes out;
  for (const unsigned char byte : kMcapMagic) out.push_back(std::byte{byte});
  PutRecord(&out, McapHeader{profile, options_.library});
  open_ = true;
  return Emit(out);
}

IoStatus McapWriter::AddSchema(const std::string& name, const std::string& encoding,
                               const std::string& data, SchemaId* id) {
  if (!open_) return IoStatus::Failed("the file is not open");
  if (schemas_.size() == std::numeric_limits<std::uint16_t>::max())
    return IoStatus::Failed("too many schemas");
  *id = static_cast<SchemaId>(schemas_.size() + 1);
  schemas_.push_back({*id, name, encoding, data});
  statistics_.schema_count = static_cast<std::uint16_t>(schemas_.size());
  scratch_.clear();
  PutRecord(&scratch_, schemas_.back());
  return Emit(scratch_);
}

IoStatus McapWriter::AddChannel(SchemaId schema_id, const std::string& topic,
                                const std::string& message_encoding, const TextMap& metadata,
                                ChannelId* id) {
  if (!open_) return IoStatus::Failed("the file is not open");
  if (static_cast<std::size_t>(schema_id) > schemas_.size())
    return IoStatus::Failed("no such schema");
  if (channels_.size() == std::numeric_limits<std::uint16_t>::max())
    return IoStatus::Failed("too many channels");
  *id = static_cast<ChannelId>(channels_.size() + 1);
  channels_.push_back({*id, schema_id, topic, message_encoding, metadata});
  sequences_.push_back(0);
  statistics_.channel_count = static_cast<std::uint32_t>(channels_.size());
  scratch_.clear();
  PutRecord(&scratch_, channels_.back());
  return Emit(scratch_);
}

IoStatus McapWriter::WriteMessage(ChannelId channel_id, std::int64_t log_time_ns,
                                  std::int64_t publish_time_ns, std::span<const std::byte> data,
                                  std::optional<std::uint32_t> sequence) {
  if (!open_) return IoStatus::Failed("the file is not open");
  if (!status_.ok()) return status_;
  const auto channel = static_cast<std::size_t>(channel_id);
  if (channel == 0 || channel > channels_.size()) return IoStatus::Failed("no such channel");
  if (log_time_ns < 0 || publish_time_ns < 0)
    return IoStatus::Failed("a time before 0 does not fit the format");

  const bool empty = chunk_.empty();
  if (!empty && (log_time_ns - chunk_start_ns_ >= options_.chunk_span_ns ||
                 chunk_.size() >= options_.chunk_bytes)) {
    if (IoStatus status = CloseChunk(); !status.ok()) return status;
  }
  if (chunk_.empty()) chunk_start_ns_ = chunk_end_ns_ = log_time_ns;
  chunk_start_ns_ = std::min(chunk_start_ns_, log_time_ns);
  chunk_end_ns_ = std::max(chunk_end_ns_, log_time_ns);
  chunk_index_[channel_id].push_back({log_time_ns, chunk_.size()});

  PutRecord(&chunk_, McapMessage{channel_id, sequence ? *sequence : sequences_[channel - 1]++,
                                 log_time_ns, publish_time_ns, data});

  if (statistics_.message_count == 0)
    statistics_.start_time_ns = statistics_.end_time_ns = log_time_ns;
  statistics_.start_time_ns = std::min(statistics_.start_time_ns, log_time_ns);
  statistics_.end_time_ns = std::max(statistics_.end_time_ns, log_time_ns);
  ++statistics_.message_count;
  ++statistics_.channel_message_counts[channel_id];
  return IoStatus::Ok();
}

IoStatus McapWriter::CloseChunk() {
  if (!status_.ok()) return status_;
  if (chunk_.empty()) return IoStatus::Ok();

  McapChunkIndex index;
  index.start_time_ns = chunk_start_ns_;
  index.end_time_ns = chunk_end_ns_;
  index.offset = offset_;
  index.compression = CompressionName(options_.compression);
  index.uncompressed_size = chunk_.size();

  scratch_.clear();
  const std::size_t start = StartRecord(&scratch_, Opcode::kChunk);
  FieldWriter{&scratch_}(index.start_time_ns, index.end_time_ns, index.uncompressed_size,
                         Crc32(chunk_), index.compression);
  const std::size_t size_at = scratch_.size();
  Put(&scratch_, std::uint64_t{0});
  Compress(options_.compression, chunk_, &scratch_);
  index.compressed_size = scratch_.size() - size_at - 8;
  PutAt(&scratch_, size_at, index.compressed_size);
  FinishRecord(&scratch_, start);
  index.length = scratch_.size();

  for (const auto& [channel, entries] : chunk_index_) {
    index.message_index_offsets[channel] = offset_ + scratch_.size();
    const std::size_t record = StartRecord(&scratch_, Opcode::kMessageIndex);
    FieldWriter fields(&scratch_);
    fields(channel, static_cast<std::uint32_t>(16 * entries.size()));
    for (const IndexEntry& entry : entries) fields(entry.log_time_ns, entry.offset);
    FinishRecord(&scratch_, record);
  }
  index.message_index_length = scratch_.size() - index.length;

  chunk_.clear();
  chunk_index_.clear();
  if (IoStatus status = Emit(scratch_); !status.ok()) return status;
  PutRecord(&chunk_records_, index);
  ++statistics_.chunk_count;
  return IoStatus::Ok();
}

IoStatus McapWriter::WriteMetadata(const McapMetadata& metadata) {
  if (!open_) return IoStatus::Failed("the file is not open");
  scratch_.clear();
  PutRecord(&scratch_, metadata);
  Located located{offset_, scratch_.size(), {}};
  FieldWriter{&located.rest}(metadata.name);
  if (IoStatus status = Emit(scratch_); !status.ok()) return status;
  metadata_.push_back(std::move(located));
  ++statistics_.metadata_count;
  return IoStatus::Ok();
}

IoStatus McapWriter::WriteAttachment(const McapAttachment& attachment) {
  if (!open_) return IoStatus::Failed("the file is not open");
  scratch_.clear();
  const std::size_t start = StartRecord(&scratch_, Opcode::kAttachment);
  VisitFields(FieldWriter(&scratch_), attachment);
  Put(&scratch_, Crc32(std::span(scratch_).subspan(start)));
  FinishRecord(&scratch_, start);
  Located located{offset_, scratch_.size(), {}};
  FieldWriter{&located.rest}(attachment.log_time_ns, UnusedTime{},
                             static_cast<std::uint64_t>(attachment.data.size()), attachment.name,
                             attachment.media_type);
  if (IoStatus status = Emit(scratch_); !status.ok()) return status;
  attachments_.push_back(std::move(located));
  ++statistics_.attachment_count;
  return IoStatus::Ok();
}

void McapWriter::AppendGroup(Opcode opcode, const Bytes& records, std::uint64_t summary_start,
                             Bytes* summary, Bytes* offsets) const {
  if (records.empty()) return;
  const std::size_t start = StartRecord(offsets, Opcode::kSummaryOffset);
  FieldWriter{offsets}(opcode, summary_start + summary->size(),
                       static_cast<std::uint64_t>(records.size()));
  FinishRecord(offsets, start);
  summary->insert(summary->end(), records.begin(), records.end());
}

IoStatus McapWriter::Close() {
  if (!open_) return IoStatus::Failed("the file is not open");
  if (IoStatus status = CloseChunk(); !status.ok()) return status;

  Bytes out;
  std::size_t start = StartRecord(&out, Opcode::kDataEnd);
  Put(&out, static_cast<std::uint32_t>(data_crc_.checksum()));
  FinishRecord(&out, start);
  if (IoStatus status = Emit(out); !status.ok()) return status;

  const std::uint64_t summary_start = offset_;
  Bytes summary;
  Bytes offsets;
  Bytes group;
  for (const McapSchema& schema : schemas_) PutRecord(&group, schema);
  AppendGroup(Opcode::kSchema, group, summary_start, &summary, &offsets);

  group.clear();
  for (const McapChannel& channel : channels_) PutRecord(&group, channel);
  AppendGroup(Opcode::kChannel, group, summary_start, &summary, &offsets);

  group.clear();
  PutRecord(&group, statistics_);
  AppendGroup(Opcode::kStatistics, group, summary_start, &summary, &offsets);

  AppendGroup(Opcode::kChunkIndex, chunk_records_, summary_start, &summary, &offsets);

  for (const auto& [opcode, records] : {std::pair{Opcode::kAttachmentIndex, &attachments_},
                                        std::pair{Opcode::kMetadataIndex, &metadata_}}) {
    group.clear();
    for (const Located& located : *records) {
      start = StartRecord(&group, opcode);
      FieldWriter{&group}(located.offset, located.length, std::span<const std::byte>(located.rest));
      FinishRecord(&group, start);
    }
    AppendGroup(opcode, group, summary_start, &summary, &offsets);
  }

  const std::uint64_t summary_offset_start = summary_start + summary.size();
  out = std::move(summary);
  out.insert(out.end(), offsets.begin(), offsets.end());
  PutRecord(&out, McapFooter{summary_start, summary_offset_start});
  // The checksum covers everything before itself.
  PutAt(&out, out.size() - 4, Crc32(std::span(out).first(out.size() - 4)));
  for (const unsigned char byte : kMcapMagic) out.push_back(std::byte{byte});
  IoStatus status = Emit(out);
  open_ = false;
  return status;
}

}  // namespace sinew::recording
