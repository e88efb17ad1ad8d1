// Received samples of one topic, between the DDS reception thread and the thread that reads.
//
// Threads: one thread pushes, one takes. Buffers of dropped samples are used again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <vector>

#include "components/node/codec.h"

namespace sinew::node::internal {

struct Sample {
  Bytes bytes;                          // CDR with its 4-byte header
  std::int64_t source_stamp_ns = 0;     // writer's clock
  std::int64_t reception_stamp_ns = 0;  // epoch time
};

class SampleQueue {
 public:
  explicit SampleQueue(std::size_t limit) : limit_(limit) {}  // 0: unlimited

  // Appends the sample; a full queue drops its oldest one. `sample` is left with a buffer to fill
  // again.
  void Push(Sample* sample);
  std::optional<Sample> TakeNext();    // the oldest
  std::optional<Sample> TakeLatest();  // the newest; the others are discarded
  bool empty() const;

 private:
  const std::size_t limit_;
  mutable std::mutex mutex_;
  std::deque<Sample> samples_;
  std::vector<Bytes> spare_;
};

}  // namespace sinew::node::internal
