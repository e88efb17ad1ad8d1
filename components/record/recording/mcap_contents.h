// Contents of an MCAP file, by its summary or a scan of its records. Internal to mcap_reader.h.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "components/record/recording/mcap.h"
#include "components/record/recording/mcap_record.h"

namespace sinew::recording {

// Recovery of a file that was cut off.
struct Recovery {
  std::uint64_t good_bytes = 0;  // from the start, up to the last whole record
  std::uint64_t lost_bytes = 0;  // after them
  std::uint64_t messages = 0;
  std::string reason;  // why reading stopped there
};

struct McapLooseMessage {  // outside chunks
  std::int64_t log_time_ns;
  std::uint64_t offset;
  std::uint64_t size;
};

struct McapContents {
  std::map<SchemaId, McapSchema> schemas;
  std::map<ChannelId, McapChannel> channels;
  std::vector<McapChunkIndex> chunks;
  std::vector<McapLooseMessage> loose;
  std::vector<std::uint64_t> metadata_offsets;
  std::vector<std::uint64_t> attachment_offsets;
  McapStatistics statistics;
  std::optional<Recovery> recovery;  // empty unless the file was cut off

  // A channel whose schema is not there; nullptr: none. Records come in any order, so this is asked
  // at their end.
  const McapChannel* WithoutSchema() const;
  // Throw McapError when the id is there already, differently. A schema with the id 0 is ignored
  // (specification).
  void AddSchema(std::uint64_t offset, McapSchema schema);
  void AddChannel(std::uint64_t offset, McapChannel channel);
};

// `end` is the byte after the footer. Nothing when the summary lacks what reading by index needs.
std::optional<McapContents> ReadSummary(const McapRecords& records, std::uint64_t end);

// Record by record from `start` to `end`. cut_off: the file has no end of its own, and what is not
// whole ends the scan instead of throwing McapError.
McapContents ScanRecords(const McapRecords& records, std::uint64_t start, std::uint64_t end,
                         bool cut_off);

}  // namespace sinew::recording
