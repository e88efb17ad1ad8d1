#include "components/record/recording/mcap_record.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "components/record/recording/compression.h"

namespace sinew::recording {
namespace {

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

void CheckFields(const Cursor& cursor, std::uint64_t offset, Opcode opcode) {
  if (!cursor.ok()) {
    throw McapError(offset, "record " + OpcodeText(opcode) + " is shorter than its fields");
  }
}

std::int64_t GetTime(Cursor* cursor) {
  return static_cast<std::int64_t>(std::min<std::uint64_t>(
      cursor->Get<std::uint64_t>(), std::numeric_limits<std::int64_t>::max()));
}

}  // namespace

Bytes McapRecords::ReadBytes(std::uint64_t offset, std::uint64_t size) const {
  if (offset > source_.size() || size > source_.size() - offset) {
    throw McapError(offset, "the file ends inside a record");
  }
  Bytes bytes(static_cast<std::size_t>(size));
  if (const IoStatus status = source_.Read(offset, bytes); !status.ok()) {
    throw McapError(offset, "cannot be read: " + status.message());
  }
  return bytes;
}

McapRecord McapRecords::ReadHead(std::uint64_t offset, std::uint64_t end) const {
  if (end - offset < McapRecord::kHeadSize)
    throw McapError(offset, "the file ends inside a record");
  const Bytes head = ReadBytes(offset, McapRecord::kHeadSize);
  Cursor cursor(head);
  McapRecord record;
  record.offset = offset;
  record.opcode = static_cast<Opcode>(cursor.Get<std::uint8_t>());
  record.size = cursor.Get<std::uint64_t>();
  if (record.opcode == Opcode{0}) throw McapError(offset, "no record begins here (opcode 0)");
  if (record.size > end - offset - McapRecord::kHeadSize) {
    throw McapError(offset, "record " + OpcodeText(record.opcode) + " of " +
                                std::to_string(record.size) + " bytes is longer than the file");
  }
  return record;
}

McapRecord McapRecords::ReadHeadOf(Opcode opcode, std::uint64_t offset,
                                   const std::string& what) const {
  const McapRecord record = ReadHead(offset, size());
  if (record.opcode != opcode) throw McapError(offset, "expected " + what + " here");
  return record;
}

std::string OpcodeText(Opcode opcode) {
  constexpr char kDigits[] = "0123456789abcdef";
  const auto value = static_cast<unsigned>(opcode);
  return std::string("0x") + kDigits[value >> 4] + kDigits[value & 15];
}

McapHeader ParseHeader(std::uint64_t offset, std::span<const std::byte> content) {
  Cursor cursor(content);
  McapHeader header;
  header.profile = cursor.GetText();
  header.library = cursor.GetText();
  CheckFields(cursor, offset, Opcode::kHeader);
  return header;
}

McapFooter ParseFooter(std::uint64_t offset, std::span<const std::byte> content) {
  Cursor cursor(content);
  McapFooter footer;
  footer.summary_start = cursor.Get<std::uint64_t>();
  footer.offsets_start = cursor.Get<std::uint64_t>();
  footer.summary_crc = cursor.Get<std::uint32_t>();
  CheckFields(cursor, offset, Opcode::kFooter);
  return footer;
}

McapSchema ParseSchema(std::uint64_t offset, std::span<const std::byte> content) {
  Cursor cursor(content);
  McapSchema schema;
  schema.id = static_cast<SchemaId>(cursor.Get<std::uint16_t>());
  schema.name = cursor.GetText();
  schema.encoding = cursor.GetText();
  schema.data = cursor.GetText();
  CheckFields(cursor, offset, Opcode::kSchema);
  return schema;
}

McapChannel ParseChannel(std::uint64_t offset, std::span<const std::byte> content) {
  Cursor cursor(content);
  McapChannel channel;
  channel.id = static_cast<ChannelId>(cursor.Get<std::uint16_t>());
  channel.schema_id = static_cast<SchemaId>(cursor.Get<std::uint16_t>());
  channel.topic = cursor.GetText();
  channel.message_encoding = cursor.GetText();
  channel.metadata = GetTextMap(&cursor);
  CheckFields(cursor, offset, Opcode::kChannel);
  return channel;
}

McapMessageHead ParseMessageHead(std::uint64_t offset, Cursor* cursor) {
  McapMessageHead head;
  head.channel_id = static_cast<ChannelId>(cursor->Get<std::uint16_t>());
  head.sequence = cursor->Get<std::uint32_t>();
  head.log_time_ns = GetTime(cursor);
  head.publish_time_ns = GetTime(cursor);
  CheckFields(*cursor, offset, Opcode::kMessage);
  return head;
}

McapStatistics ParseStatistics(std::uint64_t offset, std::span<const std::byte> content) {
  Cursor cursor(content);
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
  CheckFields(cursor, offset, Opcode::kStatistics);
  return statistics;
}

McapChunkIndex ParseChunkIndex(std::uint64_t offset, std::span<const std::byte> content) {
  Cursor cursor(content);
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
  CheckFields(cursor, offset, Opcode::kChunkIndex);
  return index;
}

std::uint64_t ParseIndexedOffset(std::uint64_t offset, Opcode opcode,
                                 std::span<const std::byte> content) {
  Cursor cursor(content);
  const auto indexed = cursor.Get<std::uint64_t>();
  CheckFields(cursor, offset, opcode);
  return indexed;
}

McapMetadata ParseMetadata(std::uint64_t offset, std::span<const std::byte> content) {
  Cursor cursor(content);
  McapMetadata metadata;
  metadata.name = cursor.GetText();
  metadata.values = GetTextMap(&cursor);
  CheckFields(cursor, offset, Opcode::kMetadata);
  return metadata;
}

McapAttachment ParseAttachment(std::uint64_t offset, std::span<const std::byte> content) {
  Cursor cursor(content);
  McapAttachment attachment;
  attachment.log_time_ns = GetTime(&cursor);
  GetTime(&cursor);  // created
  attachment.name = cursor.GetText();
  attachment.media_type = cursor.GetText();
  attachment.data = Cursor::AsText(cursor.Take(cursor.Get<std::uint64_t>()));
  const std::size_t checked = cursor.position();
  const auto crc = cursor.Get<std::uint32_t>();
  CheckFields(cursor, offset, Opcode::kAttachment);
  if (crc != 0 && Crc32(content.first(checked)) != crc) {
    throw McapError(offset, "the checksum of the attachment is wrong");
  }
  return attachment;
}

Bytes OpenChunk(std::uint64_t offset, std::span<const std::byte> content, McapChunkIndex* index) {
  Cursor cursor(content);
  index->offset = offset;
  index->length = McapRecord::kHeadSize + content.size();
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

}  // namespace sinew::recording
