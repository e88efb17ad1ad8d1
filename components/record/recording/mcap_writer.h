// Writes an MCAP file: chunked, indexed, with checksums.
//
// Messages wait in a chunk in memory until the chunk spans `chunk_span_ns` of log time or
// `chunk_bytes`, or CloseChunk is called: what a killed writer loses is the open chunk. Every write
// is checked. After the first failure nothing more is written and every call gives that failure
// again. Thread: one at a time.
#pragma once

#include <boost/crc.hpp>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "components/record/recording/bytes.h"
#include "components/record/recording/compression.h"
#include "components/record/recording/io.h"
#include "components/record/recording/mcap.h"

namespace sinew::recording {

struct McapWriterOptions {
  std::string library = "sinew";
  Compression compression = Compression::kZstd;
  std::int64_t chunk_span_ns = 100'000'000;
  std::size_t chunk_bytes = 1u << 20;
};

class McapWriter {
 public:
  // Keeps a reference to the sink.
  explicit McapWriter(ByteSink& sink, McapWriterOptions options = {});
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  IoStatus Open();  // magic and header
  // With a profile of the MCAP registry, "ros2"; Open() has none.
  IoStatus Open(const std::string& profile);
  IoStatus AddSchema(const std::string& name, const std::string& encoding, const std::string& data,
                     SchemaId* id);
  IoStatus AddChannel(SchemaId schema_id, const std::string& topic,
                      const std::string& message_encoding, const TextMap& metadata, ChannelId* id);
  // sequence: of the message record; none: the messages of the channel are numbered from 0 on.
  // Negative times are refused.
  IoStatus WriteMessage(ChannelId channel_id, std::int64_t log_time_ns,
                        std::int64_t publish_time_ns, std::span<const std::byte> data,
                        std::optional<std::uint32_t> sequence = std::nullopt);
  IoStatus WriteMetadata(const McapMetadata& metadata);
  IoStatus WriteAttachment(const McapAttachment& attachment);
  // Hands the open chunk to the sink. Nothing to do when it is empty.
  IoStatus CloseChunk();
  // Closes the chunk, writes summary, footer and magic.
  IoStatus Close();

  bool chunk_is_open() const { return !chunk_.empty(); }
  std::uint64_t bytes_written() const { return offset_; }
  const McapStatistics& statistics() const { return statistics_; }

 private:
  struct IndexEntry {
    std::int64_t log_time_ns;
    std::uint64_t offset;
  };
  struct Located {  // a record the summary points at
    std::uint64_t offset;
    std::uint64_t length;
    Bytes rest;  // of its index record
  };

  IoStatus Emit(const Bytes& bytes);
  void AppendGroup(Opcode opcode, const Bytes& records, std::uint64_t summary_start, Bytes* summary,
                   Bytes* offsets) const;

  ByteSink& sink_;
  const McapWriterOptions options_;
  IoStatus status_;
  bool open_ = false;
  std::uint64_t offset_ = 0;
  boost::crc_32_type data_crc_;

  Bytes chunk_;
  std::int64_t chunk_start_ns_ = 0;
  std::int64_t chunk_end_ns_ = 0;
  std::map<ChannelId, std::vector<IndexEntry>> chunk_index_;

  std::vector<McapSchema> schemas_;
  std::vector<McapChannel> channels_;
  std::vector<std::uint32_t> sequences_;
  Bytes chunk_records_;  // of the summary, as they will be written: all that grows with the file
  std::vector<Located> attachments_;
  std::vector<Located> metadata_;
  McapStatistics statistics_;
  Bytes scratch_;
};

}  // namespace sinew::recording
