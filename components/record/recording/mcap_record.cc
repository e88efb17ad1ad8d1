#include "components/record/recording/mcap_record.h"

#include <algorithm>
#include <concepts>
#include <limits>
#include <map>
#include <type_traits>
#include <utility>

#include "components/record/recording/compression.h"
#include "components/record/recording/mcap_fields.h"

namespace sinew::recording {
namespace {

void CheckFields(const Cursor& cursor, std::uint64_t offset, Opcode opcode) {
  if (!cursor.ok()) {
    throw McapError(offset, "record " + OpcodeText(opcode) + " is shorter than its fields");
  }
}

// Fields out of a record's content.
class FieldReader {
 public:
  explicit FieldReader(Cursor* cursor) : cursor_(*cursor) {}

  template <class... Field>
  void operator()(Field&&... fields) {
    (Read(fields), ...);
  }

 private:
  template <std::unsigned_integral Number>
  void Read(Number& number) {
    number = cursor_.Get<Number>();
  }
  template <class Id>
  requires std::is_enum_v<Id>
  void Read(Id& id) { id = static_cast<Id>(cursor_.Get<std::underlying_type_t<Id>>()); }
  void Read(std::int64_t& time_ns) {
    time_ns = static_cast<std::int64_t>(std::min<std::uint64_t>(
        cursor_.Get<std::uint64_t>(), std::numeric_limits<std::int64_t>::max()));
  }
  void Read(UnusedTime) { cursor_.Get<std::uint64_t>(); }
  void Read(std::string& text) { text = cursor_.GetText(); }
  void Read(Verbatim<std::string> field) { field.text = cursor_.GetText(); }
  void Read(LongText<std::string> field) {
    field.text = Cursor::AsText(cursor_.Take(cursor_.Get<std::uint64_t>()));
  }
  void Read(std::span<const std::byte>& data) { data = cursor_.Take(cursor_.remaining()); }
  void Read(TextMap& map) {
    Cursor entries(cursor_.Take(cursor_.Get<std::uint32_t>()));
    while (entries.remaining() > 0 && entries.ok()) {
      std::string key = entries.GetText();
      std::string value = entries.GetText();
      if (entries.ok()) map.insert_or_assign(std::move(key), std::move(value));
    }
    if (!entries.ok()) cursor_.Take(~std::uint64_t{0});  // marks the cursor as broken
  }
  void Read(std::map<ChannelId, std::uint64_t>& by_channel) {
    Cursor entries(cursor_.Take(cursor_.Get<std::uint32_t>()));
    while (entries.remaining() >= 10) {
      const auto channel = static_cast<ChannelId>(entries.Get<std::uint16_t>());
      by_channel[channel] = entries.Get<std::uint64_t>();
    }
  }

  Cursor& cursor_;
};

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

template <class Record>
Record Parse(std::uint64_t offset, std::span<const std::byte> content) {
  Cursor cursor(content);
  Record record;
  VisitFields(FieldReader(&cursor), record);
  if constexpr (std::same_as<Record, McapAttachment>) {
    const std::size_t checked = cursor.position();
    const auto crc = cursor.Get<std::uint32_t>();
    CheckFields(cursor, offset, Record::kOpcode);
    if (crc != 0 && Crc32(content.first(checked)) != crc) {
      throw McapError(offset, "the checksum of the attachment is wrong");
    }
  }
  CheckFields(cursor, offset, Record::kOpcode);
  return record;
}

template McapHeader Parse(std::uint64_t, std::span<const std::byte>);
template McapFooter Parse(std::uint64_t, std::span<const std::byte>);
template McapSchema Parse(std::uint64_t, std::span<const std::byte>);
template McapChannel Parse(std::uint64_t, std::span<const std::byte>);
template McapMessage Parse(std::uint64_t, std::span<const std::byte>);
template McapStatistics Parse(std::uint64_t, std::span<const std::byte>);
template McapChunkIndex Parse(std::uint64_t, std::span<const std::byte>);
template McapMetadata Parse(std::uint64_t, std::span<const std::byte>);
template McapAttachment Parse(std::uint64_t, std::span<const std::byte>);

std::uint64_t ParseIndexedOffset(std::uint64_t offset, Opcode opcode,
                                 std::span<const std::byte> content) {
  Cursor cursor(content);
  const auto indexed = cursor.Get<std::uint64_t>();
  CheckFields(cursor, offset, opcode);
  return indexed;
}

Bytes OpenChunk(std::uint64_t offset, std::span<const std::byte> content, McapChunkIndex* index) {
  Cursor cursor(content);
  index->offset = offset;
  index->length = McapRecord::kHeadSize + content.size();
  std::uint32_t crc = 0;
  FieldReader{&cursor}(index->start_time_ns, index->end_time_ns, index->uncompressed_size, crc,
                       index->compression, index->compressed_size);
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
