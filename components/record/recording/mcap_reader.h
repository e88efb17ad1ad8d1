// Reads MCAP files: through their index, or record by record when they were cut off (a killed
// logger).
//
// A file that begins and ends as it should but is wrong inside is broken: McapError with the byte.
// A file without its end is recovered: everything up to the first record that is not whole, and
// `recovery()` says how much that is. Foreign files with zstd, LZ4 or plain chunks, or without
// chunks, are read.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "components/record/recording/io.h"
#include "components/record/recording/mcap.h"
#include "components/record/recording/mcap_contents.h"
#include "components/record/recording/mcap_messages.h"
#include "components/record/recording/mcap_record.h"

namespace sinew::recording {

class McapReader {
 public:
  // Reads header and summary, or scans. Keeps a reference to the source. Throws McapError.
  explicit McapReader(ByteSource& source);
  McapReader(const McapReader&) = delete;
  McapReader& operator=(const McapReader&) = delete;

  const std::string& profile() const { return header_.profile; }
  const std::string& library() const { return header_.library; }
  const std::map<SchemaId, McapSchema>& schemas() const { return contents_.schemas; }
  const std::map<ChannelId, McapChannel>& channels() const { return contents_.channels; }
  const std::vector<McapChunkIndex>& chunks() const { return contents_.chunks; }
  const McapStatistics& statistics() const { return contents_.statistics; }
  // Empty unless the file was cut off.
  const std::optional<Recovery>& recovery() const { return contents_.recovery; }
  // nullptr: no schema.
  const McapSchema* SchemaOf(const McapChannel& channel) const;

  std::vector<McapMetadata> ReadMetadata() const;
  std::vector<McapAttachment> ReadAttachments() const;
  // The reader must outlive them.
  McapMessages Messages(MessageFilter filter = {}) const;

 private:
  const McapRecords records_;
  McapHeader header_;
  McapContents contents_;
};

}  // namespace sinew::recording
