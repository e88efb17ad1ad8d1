// The newest samples that a file repeats of what came before it: what a reader that joined at the
// beginning of the file would need to be given.
//
// Of a topic whose samples stay valid until the next one, each writer's newest one of each instance
// (key), in the order in which they came. Bounded in number; payloads of such topics are bounded by
// their types (about 1 KiB), so that the memory is, too. Thread: one at a time. Allocates.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "components/record/logger/recorded_message.h"
#include "components/record/recording/mcap.h"

namespace sinew::logger {

// Samples of a topic that are repeated.
enum class Repeats {
  kNothing,        // the next cycle brings a new one
  kNoSession,      // nothing, either: lines of a log, which may be of an earlier session
  kOfLiveWriters,  // status: as long as the writer is there
  kOfTheSession,   // requests: in force in their session, also when who asked has gone
};

struct LatchedSample {
  RecordedMessage message;
  recording::TextMap writer;  // what is known of the writer, from the time when it was there
};

class LatchedSamples {
 public:
  // Samples that are kept at most; the one that came first goes. 64 participants with two status
  // topics and six topics of requests each.
  static constexpr std::size_t kMost = 512;

  // by topic; shorter: nothing is repeated of the others.
  explicit LatchedSamples(std::vector<Repeats> repeats) : repeats_(std::move(repeats)) {}

  // Every message, in the order of reception. describe: called for a writer's first sample.
  void Keep(const RecordedMessage& message,
            const std::function<recording::TextMap(const WriterGuid&)>& describe);
  // Samples that are to be repeated now. is_live: none: all writers are there. The pointers are
  // valid until the next Keep.
  std::vector<const LatchedSample*> Now(
      const std::function<bool(const WriterGuid&)>& is_live) const;
  std::size_t size() const { return samples_.size(); }

 private:
  using Key = std::tuple<std::size_t, WriterGuid, std::uint64_t>;  // topic, writer, instance
  struct Entry {
    LatchedSample sample;
    std::uint64_t order = 0;
  };
  Repeats RepeatsOf(std::size_t topic) const {
    return topic < repeats_.size() ? repeats_[topic] : Repeats::kNothing;
  }

  const std::vector<Repeats> repeats_;
  std::map<Key, Entry> samples_;
  std::uint64_t order_ = 0;
  std::optional<std::uint64_t> session_id_;  // of the newest sample that is not repeated
};

}  // namespace sinew::logger
