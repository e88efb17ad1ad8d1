// The messages of an MCAP file in the order of their time. Made by McapReader::Messages.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "components/record/recording/mcap.h"

namespace sinew::recording {

class McapRecords;
struct McapContents;

struct MessageFilter {
  std::optional<std::set<std::string>> topics;  // none: all
  std::int64_t start_ns = 0;                    // log time, inclusive
  std::int64_t end_ns = std::numeric_limits<std::int64_t>::max();
  // As they stand in the file, whatever their log times: where a recorder's clock was set back.
  bool in_file_order = false;
};

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
  McapMessages(const McapRecords& records, const McapContents& contents, MessageFilter filter);
  std::unique_ptr<Impl> impl_;
};

}  // namespace sinew::recording
