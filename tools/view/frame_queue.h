// The frames that wait for a client: bounded, and a full queue loses its oldest data.
//
// Texts (what channels there are, reports) are never lost: a client is not read while they wait for
// it, so that few do. Not synchronized.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tools/view/protocol.h"

namespace sinew::live {

// One for all clients that a message goes to.
using Payload = std::shared_ptr<const std::vector<std::byte>>;

struct Frame {
  std::string text;          // of a text frame
  DataHead head{};           // of a data frame
  Payload payload;           // null: a text frame
  std::size_t size() const;  // bytes of memory
};

class FrameQueue {
 public:
  // Bytes of data that may wait. A single frame that is larger passes while nothing else waits.
  explicit FrameQueue(std::size_t limit_bytes) : limit_bytes_(limit_bytes) {}

  void Push(Frame frame);
  std::optional<Frame> Pop();  // the oldest
  // Data frames as far as they are the oldest, of up to so many bytes, but one at least; empty: the
  // oldest is a text, or there is none.
  std::vector<Frame> PopData(std::size_t most_bytes);

  std::size_t waiting() const { return frames_.size(); }
  std::size_t waiting_texts() const { return texts_; }
  std::size_t waiting_bytes() const { return data_bytes_; }  // of data
  std::uint64_t lost() const { return lost_; }               // data frames since the start

 private:
  const std::size_t limit_bytes_;
  std::deque<Frame> frames_;
  std::size_t data_bytes_ = 0;
  std::size_t texts_ = 0;
  std::uint64_t lost_ = 0;
};

}  // namespace sinew::live
