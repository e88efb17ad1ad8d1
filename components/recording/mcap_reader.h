// Reads MCAP files: through their index, or record by record when they were cut off (a killed
// logger).
//
// A file that begins and ends as it should but is wrong inside is broken: McapError with the byte.
// A file without its end is recovered: everything up to the first record that is not whole, and
// `recovery()` says how much that is. Foreign files with zstd, LZ4 or plain chunks, or without
// chunks, are read.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "components/recording/bytes.h"
#include "components/recording/io.h"
#include "components/recording/mcap.h"

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

struct Recovery {
  std::uint64_t good_bytes = 0;  // from the start, up to the last whole record
  std::uint64_t lost_bytes = 0;  // after them
  std::uint64_t messages = 0;
  std::string reason;  // why reading stopped there
};

struct MessageFilter {
  std::optional<std::set<std::string>> topics;  // none: all
  std::int64_t start_ns = 0;                    // log time, inclusive
  std::int64_t end_ns = std::numeric_limits<std::int64_t>::max();
};

class McapReader;

// Messages in the order of their log time; equal times stay in file order. One chunk (or a few that
// overlap) is in memory at a time. The reader must outlive it.
class McapMessages {
 public:
  McapMessages(McapMessages&&) noexcept;
  ~McapMessages();
  // False at the end. Throws McapError where the file is broken.
  bool Next(McapMessage* message);

 private:
  friend class McapReader;
  struct Impl;
  explicit McapMessages(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

class McapReader {
 public:
  // Reads header and summary, or scans. Keeps a reference to the source. Throws McapError.
  explicit McapReader(ByteSource& source);
  McapReader(const McapReader&) = delete;
  McapReader& operator=(const McapReader&) = delete;

  const std::string& profile() const { return profile_; }
  const std::string& library() const { return library_; }
  const std::map<SchemaId, McapSchema>& schemas() const { return schemas_; }
  const std::map<ChannelId, McapChannel>& channels() const { return channels_; }
  const std::vector<McapChunkIndex>& chunks() const { return chunks_; }
  const McapStatistics& statistics() const { return statistics_; }
  // Empty unless the file was cut off.
  const std::optional<Recovery>& recovery() const { return recovery_; }
  // nullptr: no schema.
  const McapSchema* SchemaOf(const McapChannel& channel) const;

  std::vector<McapMetadata> ReadMetadata() const;
  std::vector<McapAttachment> ReadAttachments() const;
  McapMessages Messages(MessageFilter filter = {}) const;

 private:
  friend class McapMessages;
  struct Record {
    Opcode opcode{};
    std::uint64_t offset = 0;  // of the opcode
    std::uint64_t size = 0;    // of the content
  };
  struct Loose {  // a message outside chunks
    std::int64_t log_time_ns;
    std::uint64_t offset;
    std::uint64_t size;
  };

  Bytes ReadBytes(std::uint64_t offset, std::uint64_t size) const;
  Record ReadRecordHead(std::uint64_t offset, std::uint64_t end) const;
  Bytes ReadContent(const Record& record) const {
    return ReadBytes(record.offset + 9, record.size);
  }
  bool ReadSummary(std::uint64_t end);
  void Scan(std::uint64_t start, std::uint64_t end, bool cut_off);
  void Take(const Record& record, const Bytes& content);
  void TakeChunk(const Record& record, const Bytes& content);
  void ParseSchema(std::uint64_t offset, Cursor cursor);
  void ParseChannel(std::uint64_t offset, Cursor cursor);
  // Uncompressed records of a chunk, checked.
  Bytes OpenChunk(std::uint64_t offset, const Bytes& content, McapChunkIndex* index) const;

  ByteSource& source_;
  std::string profile_;
  std::string library_;
  std::map<SchemaId, McapSchema> schemas_;
  std::map<ChannelId, McapChannel> channels_;
  std::vector<McapChunkIndex> chunks_;
  std::vector<Loose> loose_;
  std::vector<std::uint64_t> metadata_offsets_;
  std::vector<std::uint64_t> attachment_offsets_;
  McapStatistics statistics_;
  std::optional<Recovery> recovery_;
};

}  // namespace sinew::recording
