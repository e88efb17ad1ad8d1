// Records of an MCAP file: where they are, and their contents as structs.
//
// Pure but for the source behind McapRecords. Everything throws McapError with the byte of the
// record when it is not whole.
#pragma once

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>

#include "components/record/recording/bytes.h"
#include "components/record/recording/io.h"
#include "components/record/recording/mcap.h"

namespace sinew::recording {

// The file is no MCAP file, or broken at `offset`.
class McapError : public std::runtime_error {
 public:
  McapError(std::uint64_t offset, const std::string& what)
      : std::runtime_error("byte " + std::to_string(offset) + ": " + what), offset_(offset) {}
  std::uint64_t offset() const noexcept { return offset_; }

 private:
  std::uint64_t offset_;
};

struct McapRecord {
  static constexpr std::uint64_t kHeadSize = 9;  // opcode and length

  Opcode opcode{};
  std::uint64_t offset = 0;  // of the opcode
  std::uint64_t size = 0;    // of the content

  std::uint64_t end() const { return offset + kHeadSize + size; }
};

// The records of a source, which must outlive this.
class McapRecords {
 public:
  explicit McapRecords(ByteSource& source) : source_(source) {}

  std::uint64_t size() const { return source_.size(); }
  Bytes ReadBytes(std::uint64_t offset, std::uint64_t size) const;
  // The record at `offset`, which must fit before `end`.
  McapRecord ReadHead(std::uint64_t offset, std::uint64_t end) const;
  // The record at `offset` that is to be of that kind; `what` names it in the error.
  McapRecord ReadHeadOf(Opcode opcode, std::uint64_t offset, const std::string& what) const;
  Bytes ReadContent(const McapRecord& record) const {
    return ReadBytes(record.offset + McapRecord::kHeadSize, record.size);
  }

 private:
  ByteSource& source_;
};

std::string OpcodeText(Opcode opcode);  // "0x06"

struct McapHeader {
  static constexpr Opcode kOpcode = Opcode::kHeader;
  std::string profile;
  std::string library;
};

struct McapFooter {
  static constexpr Opcode kOpcode = Opcode::kFooter;
  std::uint64_t summary_start = 0;  // 0: no summary
  std::uint64_t offsets_start = 0;  // 0: no summary offsets
  std::uint32_t summary_crc = 0;    // 0: not known
};

// Content of a record of one of the structs with a kOpcode; the data of a message is a part of it.
// `offset` is that of the record in the file, for errors.
template <class Record>
Record Parse(std::uint64_t offset, std::span<const std::byte> content);
// Offset of the record that an attachment or metadata index points to.
std::uint64_t ParseIndexedOffset(std::uint64_t offset, Opcode opcode,
                                 std::span<const std::byte> content);

// Uncompressed records of a chunk, checked; the index gets what the chunk says of itself.
Bytes OpenChunk(std::uint64_t offset, std::span<const std::byte> content, McapChunkIndex* index);

// Calls visit(opcode, offset of the record in the chunk, content) for every record of an opened
// chunk.
template <class Visit>
void ForEachInChunk(std::uint64_t chunk_offset, std::span<const std::byte> records, Visit visit) {
  Cursor cursor(records);
  while (cursor.remaining() > 0) {
    const std::size_t at = cursor.position();
    const auto opcode = static_cast<Opcode>(cursor.Get<std::uint8_t>());
    const auto content = cursor.Take(cursor.Get<std::uint64_t>());
    if (!cursor.ok())
      throw McapError(chunk_offset, "a record inside the chunk is longer than the chunk");
    visit(opcode, at, content);
  }
}

}  // namespace sinew::recording
