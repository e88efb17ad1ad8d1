#include "components/recording/mcap_reader.h"

#include <algorithm>
#include <cstring>
#include <deque>
#include <queue>
#include <utility>

#include "components/recording/compression.h"

namespace sinew::recording {
namespace {

constexpr std::uint64_t kMagicSize = kMcapMagic.size();
constexpr std::uint64_t kFooterSize = 9 + 8 + 8 + 4;
constexpr std::uint64_t kHeadSize = 9;  // opcode and length

bool IsMagic(std::span<const std::byte> bytes) {
  return bytes.size() == kMagicSize &&
         std::memcmp(bytes.data(), kMcapMagic.data(), kMagicSize) == 0;
}

TextMap GetTextMap(Cursor* cursor) {
  TextMap map;
  Cursor entries(cursor->Take(cursor->Get<std::uint32_t>()));
  while (entries.remaining() > 0 && entries.ok()) {
    std::string key = entries.GetText();
    std::string value = entries.GetText();
    if (entries.ok()) map.insert_or_assign(std::move(key), std::move(value));
  }
  if (!entries.ok()) cursor->Take(~std::uint64_t{0});  // marks the cursor as broken
  return map;
}

std::string OpcodeText(Opcode opcode) {
  constexpr char kDigits[] = "0123456789abcdef";
  const auto value = static_cast<unsigned>(opcode);
  return std::string("0x") + kDigits[value >> 4] + kDigits[value & 15];
}

void CheckFields(const Cursor& cursor, std::uint64_t offset, Opcode opcode) {
  if (!cursor.ok()) {
    throw McapError(offset, "record " + OpcodeText(opcode) + " is shorter than its fields");
  }
}

std::int64_t GetTime(Cursor* cursor) {
  return static_cast<std::int64_t>(std::min<std::uint64_t>(
      cursor->Get<std::uint64_t>(), std::numeric_limits<std::int64_t>::max()));
}

// Fixed fields of a message record; data is what remains.
struct MessageHead {
  ChannelId channel_id{};
  std::uint32_t sequence = 0;
  std::int64_t log_time_ns = 0;
  std::int64_t publish_time_ns = 0;
};

MessageHead GetMessageHead(Cursor* cursor) {
  MessageHead head;
  head.channel_id = static_cast<ChannelId>(cursor->Get<std::uint16_t>());
  head.sequence = cursor->Get<std::uint32_t>();
  head.log_time_ns = GetTime(cursor);
  head.publish_time_ns = GetTime(cursor);
  return head;
}

// Calls visit(opcode, offset of the record in the chunk, content) for every record inside a chunk.
template <class Visit>
void ForEachInChunk(std::uint64_t chunk_offset, std::span<const std::byte> records, Visit visit) {
  Cursor cursor(records);
  while (cursor.remaining() > 0) {
    const std::size_t at = cursor.position();
    const auto opcode = static_cast<Opcode>(cursor.Get<std::uint8_t>());
    const auto size = cursor.Get<std::uint64_t>();
    const auto content = cursor.Take(size);
    if (!cursor.ok())
      throw McapError(chunk_offset, "a record inside the chunk is longer than the chunk");
    visit(opcode, at, content);
  }
}

}  // namespace

Bytes McapReader::ReadBytes(std::uint64_t offset, std::uint64_t size) const {
  if (offset > source_.size() || size > source_.size() - offset) {
    throw McapError(offset, "the file ends inside a record");
  }
  Bytes bytes(static_cast<std::size_t>(size));
  if (const IoStatus status = source_.Read(offset, bytes); !status.ok()) {
    throw McapError(offset, "cannot be read: " + status.message());
  }
  return bytes;
}

McapReader::Record McapReader::ReadRecordHead(std::uint64_t offset, std::uint64_t end) const {
  if (end - offset < kHeadSize) throw McapError(offset, "the file ends inside a record");
  const Bytes head = ReadBytes(offset, kHeadSize);
  Cursor cursor(head);
  Record record;
  record.offset = offset;
  record.opcode = static_cast<Opcode>(cursor.Get<std::uint8_t>());
  record.size = cursor.Get<std::uint64_t>();
  if (record.opcode == Opcode{0}) throw McapError(offset, "no record begins here (opcode 0)");
  if (record.size > end - offset - kHeadSize) {
    throw McapError(offset, "record " + OpcodeText(record.opcode) + " of " +
                                std::to_string(record.size) + " bytes is longer than the file");
  }
  return record;
}

McapReader::McapReader(ByteSource& source) : source_(source) {
  const std::uint64_t size = source_.size();
  if (size < kMagicSize || !IsMagic(ReadBytes(0, kMagicSize))) {
    throw McapError(0, "no MCAP file: the magic bytes are missing");
  }
  const bool whole =
      size >= 2 * kMagicSize + kFooterSize && IsMagic(ReadBytes(size - kMagicSize, kMagicSize));
  const std::uint64_t end = whole ? size - kMagicSize : size;

  const Record header = ReadRecordHead(kMagicSize, end);
  if (header.opcode != Opcode::kHeader) {
    throw McapError(kMagicSize,
                    "record " + OpcodeText(header.opcode) + ", expected the header 0x01");
  }
  const Bytes content = ReadContent(header);
  Cursor cursor(content);
  profile_ = cursor.GetText();
  library_ = cursor.GetText();
  CheckFields(cursor, header.offset, header.opcode);

  if (whole && ReadSummary(end)) return;
  Scan(header.offset + kHeadSize + header.size, end, !whole);
}

// True when the summary has everything that reading by index needs.
bool McapReader::ReadSummary(std::uint64_t end) {
  const std::uint64_t footer_offset = end - kFooterSize;
  const Record footer = ReadRecordHead(footer_offset, end);
  if (footer.opcode != Opcode::kFooter || footer.size != kFooterSize - kHeadSize) {
    throw McapError(footer_offset,
                    "record " + OpcodeText(footer.opcode) + ", expected the footer 0x02");
  }
  const Bytes content = ReadContent(footer);
  Cursor cursor(content);
  const auto summary_start = cursor.Get<std::uint64_t>();
  const auto offsets_start = cursor.Get<std::uint64_t>();
  const auto crc = cursor.Get<std::uint32_t>();
  if (summary_start == 0) return false;
  if (summary_start < kMagicSize || summary_start > footer_offset ||
      (offsets_start != 0 && (offsets_start < summary_start || offsets_start > footer_offset))) {
    throw McapError(footer_offset, "the footer points outside the file");
  }
  if (crc != 0 && Crc32(ReadBytes(summary_start, end - 4 - summary_start)) != crc) {
    throw McapError(summary_start, "the checksum of the summary is wrong");
  }
  const std::uint64_t summary_end = offsets_start == 0 ? footer_offset : offsets_start;
  bool statistics = false;
  for (std::uint64_t offset = summary_start; offset < summary_end;) {
    const Record record = ReadRecordHead(offset, summary_end);
    const Bytes bytes = ReadContent(record);
    statistics = statistics || record.opcode == Opcode::kStatistics;
    Take(record, bytes);
    offset += kHeadSize + record.size;
  }
  for (const McapChunkIndex& chunk : chunks_) {
    if (chunk.offset < kMagicSize || chunk.offset > summary_start ||
        chunk.length > summary_start - chunk.offset) {
      throw McapError(summary_start, "the chunk index points outside the file");
    }
  }
  // Without statistics or chunks there may be messages that only a scan finds.
  const bool complete =
      statistics && (statistics_.message_count == 0 || (!chunks_.empty() && !channels_.empty()));
  if (!complete) {
    schemas_.clear();
    channels_.clear();
    chunks_.clear();
    metadata_offsets_.clear();
    attachment_offsets_.clear();
    statistics_ = {};
  }
  return complete;
}

void McapReader::ParseSchema(std::uint64_t offset, Cursor cursor) {
  McapSchema schema;
  schema.id = static_cast<SchemaId>(cursor.Get<std::uint16_t>());
  schema.name = cursor.GetText();
  schema.encoding = cursor.GetText();
  schema.data = cursor.GetText();
  CheckFields(cursor, offset, Opcode::kSchema);
  if (schema.id == SchemaId{0}) return;  // invalid, to be ignored (specification)
  const auto [known, added] = schemas_.try_emplace(schema.id, schema);
  if (!added && (known->second.name != schema.name || known->second.data != schema.data)) {
    throw McapError(offset, "schema " + std::to_string(static_cast<int>(schema.id)) +
                                " is there twice, differently");
  }
}

void McapReader::ParseChannel(std::uint64_t offset, Cursor cursor) {
  McapChannel channel;
  channel.id = static_cast<ChannelId>(cursor.Get<std::uint16_t>());
  channel.schema_id = static_cast<SchemaId>(cursor.Get<std::uint16_t>());
  channel.topic = cursor.GetText();
  channel.message_encoding = cursor.GetText();
  channel.metadata = GetTextMap(&cursor);
  CheckFields(cursor, offset, Opcode::kChannel);
  if (channel.schema_id != SchemaId{0} && !schemas_.contains(channel.schema_id)) {
    throw McapError(offset,
                    "channel '" + channel.topic + "' names a schema that the file does not have");
  }
  const auto [known, added] = channels_.try_emplace(channel.id, channel);
  if (!added &&
      (known->second.topic != channel.topic || known->second.schema_id != channel.schema_id)) {
    throw McapError(offset, "channel " + std::to_string(static_cast<int>(channel.id)) +
                                " is there twice, differently");
  }
}

// A record of the data section or the summary.
void McapReader::Take(const Record& record, const Bytes& content) {
  Cursor cursor(content);
  switch (record.opcode) {
    case Opcode::kSchema:
      ParseSchema(record.offset, cursor);
      break;
    case Opcode::kChannel:
      ParseChannel(record.offset, cursor);
      break;
    case Opcode::kStatistics: {
      McapStatistics statistics;
      statistics.message_count = cursor.Get<std::uint64_t>();
      statistics.schema_count = cursor.Get<std::uint16_t>();
      statistics.channel_count = cursor.Get<std::uint32_t>();
      statistics.attachment_count = cursor.Get<std::uint32_t>();
      statistics.metadata_count = cursor.Get<std::uint32_t>();
      statistics.chunk_count = cursor.Get<std::uint32_t>();
      statistics.start_time_ns = GetTime(&cursor);
      statistics.end_time_ns = GetTime(&cursor);
      Cursor counts(cursor.Take(cursor.Get<std::uint32_t>()));
      while (counts.remaining() >= 10) {
        const auto channel = static_cast<ChannelId>(counts.Get<std::uint16_t>());
        statistics.channel_message_counts[channel] = counts.Get<std::uint64_t>();
      }
      CheckFields(cursor, record.offset, record.opcode);
      statistics_ = std::move(statistics);
      break;
    }
    case Opcode::kChunkIndex: {
      McapChunkIndex index;
      index.start_time_ns = GetTime(&cursor);
      index.end_time_ns = GetTime(&cursor);
      index.offset = cursor.Get<std::uint64_t>();
      index.length = cursor.Get<std::uint64_t>();
      Cursor offsets(cursor.Take(cursor.Get<std::uint32_t>()));
      while (offsets.remaining() >= 10) {
        const auto channel = static_cast<ChannelId>(offsets.Get<std::uint16_t>());
        index.message_index_offsets[channel] = offsets.Get<std::uint64_t>();
      }
      index.message_index_length = cursor.Get<std::uint64_t>();
      index.compression = cursor.GetText();
      index.compressed_size = cursor.Get<std::uint64_t>();
      index.uncompressed_size = cursor.Get<std::uint64_t>();
      CheckFields(cursor, record.offset, record.opcode);
      chunks_.push_back(std::move(index));
      break;
    }
    case Opcode::kAttachmentIndex:
    case Opcode::kMetadataIndex: {
      const auto offset = cursor.Get<std::uint64_t>();
      CheckFields(cursor, record.offset, record.opcode);
      (record.opcode == Opcode::kMetadataIndex ? metadata_offsets_ : attachment_offsets_)
          .push_back(offset);
      break;
    }
    default:
      break;
  }
}

Bytes McapReader::OpenChunk(std::uint64_t offset, const Bytes& content,
                            McapChunkIndex* index) const {
  Cursor cursor(content);
  index->offset = offset;
  index->length = kHeadSize + content.size();
  index->start_time_ns = GetTime(&cursor);
  index->end_time_ns = GetTime(&cursor);
  index->uncompressed_size = cursor.Get<std::uint64_t>();
  const auto crc = cursor.Get<std::uint32_t>();
  index->compression = cursor.GetText();
  index->compressed_size = cursor.Get<std::uint64_t>();
  const auto compressed = cursor.Take(index->compressed_size);
  CheckFields(cursor, offset, Opcode::kChunk);
  Bytes records;
  const std::string problem =
      Decompress(index->compression, compressed, index->uncompressed_size, &records);
  if (!problem.empty()) throw McapError(offset, "chunk: " + problem);
  if (crc != 0 && Crc32(records) != crc)
    throw McapError(offset, "the checksum of the chunk is wrong");
  return records;
}

void McapReader::TakeChunk(const Record& record, const Bytes& content) {
  McapChunkIndex index;
  const Bytes records = OpenChunk(record.offset, content, &index);
  std::map<ChannelId, std::uint64_t> counts;
  std::uint64_t messages = 0;
  ForEachInChunk(
      record.offset, records, [&](Opcode opcode, std::size_t, std::span<const std::byte> inner) {
        Cursor cursor(inner);
        if (opcode == Opcode::kSchema) ParseSchema(record.offset, cursor);
        if (opcode == Opcode::kChannel) ParseChannel(record.offset, cursor);
        if (opcode != Opcode::kMessage) return;
        const MessageHead head = GetMessageHead(&cursor);
        CheckFields(cursor, record.offset, opcode);
        if (!channels_.contains(head.channel_id)) {
          throw McapError(record.offset,
                          "a message in the chunk names a channel that the file does not have");
        }
        if (messages == 0) index.start_time_ns = index.end_time_ns = head.log_time_ns;
        index.start_time_ns = std::min(index.start_time_ns, head.log_time_ns);
        index.end_time_ns = std::max(index.end_time_ns, head.log_time_ns);
        ++counts[head.channel_id];
        ++messages;
      });
  if (messages > 0) {
    const bool first = statistics_.message_count == 0;
    statistics_.start_time_ns =
        first ? index.start_time_ns : std::min(statistics_.start_time_ns, index.start_time_ns);
    statistics_.end_time_ns =
        first ? index.end_time_ns : std::max(statistics_.end_time_ns, index.end_time_ns);
  }
  statistics_.message_count += messages;
  for (const auto& [channel, count] : counts) statistics_.channel_message_counts[channel] += count;
  chunks_.push_back(std::move(index));
}

void McapReader::Scan(std::uint64_t start, std::uint64_t end, bool cut_off) {
  std::uint64_t offset = start;
  std::string reason = "the file ends before its summary";
  try {
    while (offset < end) {
      const Record record = ReadRecordHead(offset, end);
      if (record.opcode == Opcode::kDataEnd || record.opcode == Opcode::kFooter) {
        reason = "the file ends inside its summary";
        break;
      }
      switch (record.opcode) {
        case Opcode::kSchema:
        case Opcode::kChannel:
          Take(record, ReadContent(record));
          break;
        case Opcode::kChunk:
          TakeChunk(record, ReadContent(record));
          break;
        case Opcode::kMessage: {
          const Bytes content = ReadContent(record);
          Cursor cursor(content);
          const MessageHead head = GetMessageHead(&cursor);
          CheckFields(cursor, record.offset, record.opcode);
          if (!channels_.contains(head.channel_id)) {
            throw McapError(offset, "a message names a channel that the file does not have");
          }
          loose_.push_back({head.log_time_ns, offset, record.size});
          const bool first = statistics_.message_count == 0;
          statistics_.start_time_ns =
              first ? head.log_time_ns : std::min(statistics_.start_time_ns, head.log_time_ns);
          statistics_.end_time_ns =
              first ? head.log_time_ns : std::max(statistics_.end_time_ns, head.log_time_ns);
          ++statistics_.message_count;
          ++statistics_.channel_message_counts[head.channel_id];
          break;
        }
        case Opcode::kMetadata:
          metadata_offsets_.push_back(offset);
          break;
        case Opcode::kAttachment:
          attachment_offsets_.push_back(offset);
          break;
        default:
          break;  // indexes, and records of later versions
      }
      offset += kHeadSize + record.size;
    }
  } catch (const McapError& error) {
    if (!cut_off) throw;
    reason = error.what();
  }
  statistics_.schema_count = static_cast<std::uint16_t>(schemas_.size());
  statistics_.channel_count = static_cast<std::uint32_t>(channels_.size());
  statistics_.chunk_count = static_cast<std::uint32_t>(chunks_.size());
  statistics_.metadata_count = static_cast<std::uint32_t>(metadata_offsets_.size());
  statistics_.attachment_count = static_cast<std::uint32_t>(attachment_offsets_.size());
  if (cut_off) recovery_ = Recovery{offset, end - offset, statistics_.message_count, reason};
}

const McapSchema* McapReader::SchemaOf(const McapChannel& channel) const {
  const auto found = schemas_.find(channel.schema_id);
  return found == schemas_.end() ? nullptr : &found->second;
}

std::vector<McapMetadata> McapReader::ReadMetadata() const {
  std::vector<McapMetadata> all;
  for (const std::uint64_t offset : metadata_offsets_) {
    if (offset > source_.size())
      throw McapError(offset, "the metadata index points outside the file");
    const Record record = ReadRecordHead(offset, source_.size());
    if (record.opcode != Opcode::kMetadata) throw McapError(offset, "expected metadata here");
    const Bytes content = ReadContent(record);
    Cursor cursor(content);
    McapMetadata metadata;
    metadata.name = cursor.GetText();
    metadata.values = GetTextMap(&cursor);
    CheckFields(cursor, offset, record.opcode);
    all.push_back(std::move(metadata));
  }
  return all;
}

std::vector<McapAttachment> McapReader::ReadAttachments() const {
  std::vector<McapAttachment> all;
  for (const std::uint64_t offset : attachment_offsets_) {
    if (offset > source_.size())
      throw McapError(offset, "the attachment index points outside the file");
    const Record record = ReadRecordHead(offset, source_.size());
    if (record.opcode != Opcode::kAttachment)
      throw McapError(offset, "expected an attachment here");
    const Bytes content = ReadContent(record);
    Cursor cursor(content);
    McapAttachment attachment;
    attachment.log_time_ns = GetTime(&cursor);
    GetTime(&cursor);  // created
    attachment.name = cursor.GetText();
    attachment.media_type = cursor.GetText();
    attachment.data = Cursor::AsText(cursor.Take(cursor.Get<std::uint64_t>()));
    const std::size_t checked = cursor.position();
    const auto crc = cursor.Get<std::uint32_t>();
    CheckFields(cursor, offset, record.opcode);
    if (crc != 0 && Crc32(std::span(content).first(checked)) != crc) {
      throw McapError(offset, "the checksum of the attachment is wrong");
    }
    all.push_back(std::move(attachment));
  }
  return all;
}

// Chunks are opened in the order of their start; a message is given once no unopened chunk can hold
// an earlier one.
struct McapMessages::Impl {
  struct Entry {
    std::int64_t log_time_ns;
    std::uint64_t file_order;  // chunk or loose message, then position inside
    std::size_t inner_order;
    std::shared_ptr<const Bytes> bytes;
    std::size_t start;
    std::size_t size;

    bool operator>(const Entry& other) const {
      return std::tie(log_time_ns, file_order, inner_order) >
             std::tie(other.log_time_ns, other.file_order, other.inner_order);
    }
  };
  struct Part {  // a chunk or a loose message not opened yet
    std::int64_t start_time_ns;
    std::uint64_t offset;
    std::uint64_t size;
    bool chunk;
  };

  const McapReader* reader = nullptr;
  MessageFilter filter;
  std::set<ChannelId> wanted;
  std::deque<Part> parts;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> waiting;
  Entry current{};

  void AddMessage(const std::shared_ptr<const Bytes>& bytes, std::span<const std::byte> content,
                  std::uint64_t offset, std::size_t inner) {
    Cursor cursor(content);
    const MessageHead head = GetMessageHead(&cursor);
    CheckFields(cursor, offset, Opcode::kMessage);
    if (!reader->channels().contains(head.channel_id)) {
      throw McapError(offset, "a message names a channel that the file does not have");
    }
    if (!wanted.contains(head.channel_id)) return;
    if (head.log_time_ns < filter.start_ns || head.log_time_ns > filter.end_ns) return;
    waiting.push({head.log_time_ns, offset, inner, bytes,
                  static_cast<std::size_t>(content.data() - bytes->data()), content.size()});
  }

  void OpenPart() {
    const Part part = parts.front();
    parts.pop_front();
    if (!part.chunk) {
      const auto bytes =
          std::make_shared<const Bytes>(reader->ReadBytes(part.offset + kHeadSize, part.size));
      AddMessage(bytes, *bytes, part.offset, 0);
      return;
    }
    const McapReader::Record record = reader->ReadRecordHead(part.offset, reader->source_.size());
    if (record.opcode != Opcode::kChunk) throw McapError(part.offset, "expected a chunk here");
    McapChunkIndex index;
    const auto bytes = std::make_shared<const Bytes>(
        reader->OpenChunk(part.offset, reader->ReadContent(record), &index));
    ForEachInChunk(part.offset, *bytes,
                   [&](Opcode opcode, std::size_t at, std::span<const std::byte> content) {
                     if (opcode == Opcode::kMessage) AddMessage(bytes, content, part.offset, at);
                   });
  }
};

McapMessages::McapMessages(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
McapMessages::McapMessages(McapMessages&&) noexcept = default;
McapMessages::~McapMessages() = default;

bool McapMessages::Next(McapMessage* message) {
  Impl& impl = *impl_;
  while (!impl.parts.empty() && (impl.waiting.empty() || impl.parts.front().start_time_ns <=
                                                             impl.waiting.top().log_time_ns)) {
    impl.OpenPart();
  }
  if (impl.waiting.empty()) return false;
  impl.current = impl.waiting.top();
  impl.waiting.pop();
  Cursor cursor(std::span(*impl.current.bytes).subspan(impl.current.start, impl.current.size));
  const MessageHead head = GetMessageHead(&cursor);
  message->channel_id = head.channel_id;
  message->sequence = head.sequence;
  message->log_time_ns = head.log_time_ns;
  message->publish_time_ns = head.publish_time_ns;
  message->data = cursor.Take(cursor.remaining());
  return true;
}

McapMessages McapReader::Messages(MessageFilter filter) const {
  auto impl = std::make_unique<McapMessages::Impl>();
  impl->reader = this;
  for (const auto& [id, channel] : channels_) {
    if (!filter.topics || filter.topics->contains(channel.topic)) impl->wanted.insert(id);
  }
  for (const McapChunkIndex& chunk : chunks_) {
    if (chunk.end_time_ns < filter.start_ns || chunk.start_time_ns > filter.end_ns) continue;
    const bool unknown = chunk.message_index_offsets.empty();
    const bool any =
        std::any_of(chunk.message_index_offsets.begin(), chunk.message_index_offsets.end(),
                    [&](const auto& entry) { return impl->wanted.contains(entry.first); });
    if (unknown || any)
      impl->parts.push_back({chunk.start_time_ns, chunk.offset, chunk.length, true});
  }
  for (const Loose& loose : loose_) {
    impl->parts.push_back({loose.log_time_ns, loose.offset, loose.size, false});
  }
  std::stable_sort(impl->parts.begin(), impl->parts.end(), [](const auto& a, const auto& b) {
    return std::tie(a.start_time_ns, a.offset) < std::tie(b.start_time_ns, b.offset);
  });
  impl->filter = std::move(filter);
  return McapMessages(std::move(impl));
}

}  // namespace sinew::recording
