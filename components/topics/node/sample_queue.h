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

#include "components/topics/node/codec.h"
#include "components/topics/node/options.h"
#include "components/topics/node/topic.h"
#include "components/topics/node/writer_id.h"

namespace sinew::node::internal {

struct Sample {
  Bytes bytes;                          // CDR with its 4-byte header
  std::int64_t source_stamp_ns = 0;     // writer's clock
  std::int64_t reception_stamp_ns = 0;  // epoch time
  WriterId writer{};
};

// Limit of a reader's unread samples, by what is lost with them. In real time states and commands
// are worth nothing once there are newer ones; events and latched samples are kept unless the
// reader has stopped reading. In lockstep nothing may be lost: a reader that the provider does not
// await may be minutes behind, and beyond the limit it has failed, not fallen behind.
constexpr std::size_t QueueLimit(Profile profile, TimeMode mode) {
  if (mode == TimeMode::kLockstep) return 65536;
  return profile == Profile::kState || IsExclusive(profile) ? 8 : 256;
}

class SampleQueue {
 public:
  explicit SampleQueue(std::size_t limit) : limit_(limit) {}  // samples, at least 1

  // Appends the sample; a full queue drops its oldest one: false then. `sample` is left with a
  // buffer to fill again.
  bool Push(Sample* sample);
  std::optional<Sample> TakeNext();    // the oldest
  std::optional<Sample> TakeLatest();  // the newest; the others are discarded
  bool empty() const;
  std::uint64_t dropped() const;  // by Push, since the start

 private:
  const std::size_t limit_;
  mutable std::mutex mutex_;
  std::deque<Sample> samples_;
  std::vector<Bytes> spare_;
  std::uint64_t dropped_ = 0;
};

}  // namespace sinew::node::internal
