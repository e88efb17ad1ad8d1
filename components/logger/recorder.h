// The part of a recorder between reception and file: a bounded queue, and a thread that writes.
//
// Reception threads offer samples and never wait (real time) or wait for capacity (lockstep, where
// nothing may be dropped). What does not fit is counted. The writing thread makes payloads
// canonical, numbers and stamps them, and closes chunks by time, so that a killed process loses at
// most twice `chunk_span`. Write errors stop the recording at once and stay in state().status.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "components/recording/cdr.h"
#include "components/recording/io.h"
#include "components/recording/mcap_writer.h"
#include "components/recording/run_import.h"

namespace sinew::logger {

struct RecorderOptions {
  std::size_t queue_bytes = 16u << 20;
  bool wait_for_capacity = false;  // lockstep
  std::chrono::milliseconds chunk_span{100};
};

struct TopicState {
  std::uint64_t messages = 0;
  std::uint64_t dropped = 0;
  std::uint64_t malformed = 0;  // recorded as they were, though they do not fit their type
  std::uint64_t session_id = 0;
  std::uint64_t tick = 0;  // of the newest message
};

// What a joint_state said last.
struct SessionState {
  std::uint64_t session_id = 0;
  std::uint64_t tick = 0;
  std::int64_t stamp_ns = 0;
  std::int64_t origin = 0;
  bool last_tick = false;
};

struct RecorderState {
  std::vector<TopicState> topics;  // as given to the constructor
  std::optional<SessionState> session;
  std::uint64_t messages = 0;
  std::uint64_t dropped = 0;
  std::uint64_t malformed = 0;
  std::uint64_t missing_ticks = 0;  // gaps in the ticks of joint_state
  std::uint64_t bytes = 0;          // of the file
  recording::IoStatus status;       // the first write error
};

class Recorder {
 public:
  // Starts the thread; it opens the file and writes the metadata. Keeps a reference to the sink.
  // Throws recording::IdlError when a topic's schema cannot be read.
  Recorder(recording::ByteSink& sink, std::vector<recording::TopicSchema> topics,
           std::vector<recording::McapMetadata> metadata, RecorderOptions options = {});
  ~Recorder();  // ends the thread; without Finish the file has no summary
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  // Any thread. False: not taken (queue full, write error, finished).
  bool Offer(std::size_t topic, recording::Bytes payload, std::int64_t reception_ns);
  RecorderState state() const;
  // Writes what waits, and the summary. Once; from one thread.
  recording::IoStatus Finish();

 private:
  struct Item {
    std::size_t topic;
    recording::Bytes payload;
    std::int64_t reception_ns;
  };
  struct Topic;

  void Run();
  recording::IoStatus Write(Item* item);

  const RecorderOptions options_;
  recording::McapWriter writer_;
  std::vector<recording::McapMetadata> metadata_;
  std::vector<std::unique_ptr<Topic>> topics_;

  mutable std::mutex mutex_;
  std::condition_variable offered_;
  std::condition_variable taken_;
  std::deque<Item> queue_;
  std::size_t queued_bytes_ = 0;
  bool finishing_ = false;
  bool abandoned_ = false;
  RecorderState state_;
  std::thread thread_;
};

}  // namespace sinew::logger
