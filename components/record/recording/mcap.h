// Records of the MCAP container, version 0 (https://mcap.dev/spec), as far as we write and read
// them.
//
//   magic  header  { schema | channel | chunk, message index... | attachment | metadata }  data end
//   summary: schemas, channels, statistics, chunk, attachment and metadata indexes; summary offsets
//   footer  magic
//
// Integers are little-endian; times are nanoseconds. Writer: mcap_writer.h, reader: mcap_reader.h.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>

namespace sinew::recording {

enum class SchemaId : std::uint16_t {};  // 0: none
enum class ChannelId : std::uint16_t {};

inline constexpr std::array<unsigned char, 8> kMcapMagic = {0x89, 'M', 'C',  'A',
                                                            'P',  '0', '\r', '\n'};

enum class Opcode : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kAttachment = 0x09,
  kAttachmentIndex = 0x0A,
  kStatistics = 0x0B,
  kMetadata = 0x0C,
  kMetadataIndex = 0x0D,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F,
};

using TextMap = std::map<std::string, std::string>;

struct McapSchema {
  static constexpr Opcode kOpcode = Opcode::kSchema;
  SchemaId id{};
  std::string name;      // "sinew::msg::JointState"
  std::string encoding;  // "omgidl"
  std::string data;
};

struct McapChannel {
  static constexpr Opcode kOpcode = Opcode::kChannel;
  ChannelId id{};
  SchemaId schema_id{};
  std::string topic;
  std::string message_encoding;  // "cdr"
  TextMap metadata;
};

struct McapMessage {
  static constexpr Opcode kOpcode = Opcode::kMessage;
  ChannelId channel_id{};
  std::uint32_t sequence = 0;
  std::int64_t log_time_ns = 0;      // reception
  std::int64_t publish_time_ns = 0;  // stamp of the message
  std::span<const std::byte> data;   // valid until the next call of its reader
};

struct McapChunkIndex {
  static constexpr Opcode kOpcode = Opcode::kChunkIndex;
  std::int64_t start_time_ns = 0;
  std::int64_t end_time_ns = 0;
  std::uint64_t offset = 0;                                  // of the chunk record in the file
  std::uint64_t length = 0;                                  // of the whole record
  std::map<ChannelId, std::uint64_t> message_index_offsets;  // empty: not known
  std::uint64_t message_index_length = 0;
  std::string compression;
  std::uint64_t compressed_size = 0;
  std::uint64_t uncompressed_size = 0;
};

struct McapMetadata {
  static constexpr Opcode kOpcode = Opcode::kMetadata;
  std::string name;
  TextMap values;
};

struct McapAttachment {
  static constexpr Opcode kOpcode = Opcode::kAttachment;
  std::string name;
  std::string media_type;
  std::int64_t log_time_ns = 0;
  std::string data;
};

struct McapStatistics {
  static constexpr Opcode kOpcode = Opcode::kStatistics;
  std::uint64_t message_count = 0;
  std::uint16_t schema_count = 0;
  std::uint32_t channel_count = 0;
  std::uint32_t attachment_count = 0;
  std::uint32_t metadata_count = 0;
  std::uint32_t chunk_count = 0;
  std::int64_t start_time_ns = 0;
  std::int64_t end_time_ns = 0;
  std::map<ChannelId, std::uint64_t> channel_message_counts;
};

}  // namespace sinew::recording
