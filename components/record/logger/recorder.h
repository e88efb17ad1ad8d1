// The part of a recorder between reception and file: a bounded queue, and a thread that writes.
//
// Reception threads offer samples and never wait (real time) or wait for capacity (lockstep, where
// nothing may be dropped). What does not fit is counted. The writing thread wakes every
// `batch_span` (in lockstep as soon as there is something), makes payloads canonical and hands them
// to the files, or to a ring in memory until a fault or a request says that it is to be written. A
// killed process loses at most batch_span (queue) + FilesOptions::chunk_span + 2 batch_span (until
// the chunk's age is seen, and until it is over) of messages. Write errors stop the writing at once
// and stay in state().status.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "components/record/logger/message_ring.h"
#include "components/record/logger/recorded_files.h"
#include "components/record/logger/topic_reader.h"

namespace sinew::logger {

// Nothing is written until a trigger: then the last seconds, and what comes for some time.
struct RingOptions {
  std::chrono::nanoseconds last{0};  // 0: no ring, everything is written
  std::chrono::nanoseconds after = std::chrono::seconds(10);
  bool on_fault = false;           // a fault of a component or of the robot is a trigger
  std::size_t bytes = 512u << 20;  // of memory at most
};

struct RecorderOptions {
  std::size_t queue_bytes = 16u << 20;
  bool wait_for_capacity = false;  // lockstep
  // After a write error: go on reading what is offered, so that state().session goes on too.
  bool read_on_after_error = false;
  std::chrono::milliseconds batch_span{20};
  FilesOptions files = {};
  RingOptions ring = {};
};

struct TopicState {
  std::uint64_t messages = 0;
  TopicLosses losses;
  std::uint64_t session_id = 0;
  std::uint64_t tick = 0;  // of the newest message
};

// Content of the last joint_state.
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
  TopicLosses losses;                // of all topics
  std::uint64_t messages = 0;        // taken from the queue
  std::uint64_t written = 0;         // of them in files; the others were or are in the ring
  std::uint64_t missing_ticks = 0;   // gaps in the ticks of joint_state
  std::uint64_t bytes = 0;           // of the files
  int files = 0;                     // begun
  int triggers = 0;                  // of the ring
  std::uint64_t ring_forgotten = 0;  // messages that a ring too small in bytes lacked
  std::string last_trigger;
  recording::IoStatus status;  // the first write error
};

class Recorder {
 public:
  // Starts the thread; it begins the first file, but for a ring. Keeps a reference to the sink.
  // Throws recording::IdlError when a topic's schema cannot be read.
  Recorder(RecordingSink& sink, const std::vector<recording::TopicSchema>& topics,
           std::vector<recording::McapMetadata> metadata, RecorderOptions options = {});
  ~Recorder();  // ends the thread; without Finish the file has no summary
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  // Any thread. False: not taken (queue full, finished, or a write error after which it does not
  // read on).
  bool Offer(std::size_t topic, recording::Bytes payload, std::int64_t reception_ns,
             const SampleOrigin& origin = {});
  // Samples of a topic that DDS reports as lost, since the start. Any thread.
  void SetLost(std::size_t topic, std::uint64_t lost);
  // Writes the ring and what comes. Nothing without a ring. Any thread.
  void Trigger(const std::string& reason);
  RecorderState state() const;
  // Writes what waits, and the summary. Once; from one thread.
  recording::IoStatus Finish();

 private:
  using Instant = RecordedFiles::Instant;

  void Run();
  // Functions of the writing thread.
  recording::IoStatus Take(RecordedMessage&& message);
  void Note(const RecordedMessage& message, const MessageFacts& facts);
  bool IsNewFault(const RecordedMessage& message, const MessageFacts& facts);
  recording::IoStatus WriteRing(const std::string& reason);
  recording::IoStatus TakeBatch(std::vector<RecordedMessage>* batch,
                                const std::optional<std::string>& request);
  void ReadOn(std::vector<RecordedMessage>* batch);
  bool Takes() const { return state_.status.ok() || options_.read_on_after_error; }  // mutex_ held
  bool has_ring() const { return options_.ring.last.count() > 0; }
  void Publish(const recording::IoStatus& status);  // with mutex_ held

  const RecorderOptions options_;
  std::vector<std::unique_ptr<TopicReader>> readers_;

  // Members of the writing thread.
  RecordedFiles files_;
  MessageRing ring_;
  Instant ring_closes_{};  // while a file of the ring is open
  RecorderState own_;
  std::map<std::pair<std::size_t, WriterGuid>, std::uint64_t> last_sequence_;
  std::map<std::pair<std::size_t, WriterGuid>, bool> in_fault_;

  mutable std::mutex mutex_;
  std::condition_variable offered_;
  std::condition_variable taken_;
  std::vector<RecordedMessage> queue_;
  std::size_t queued_bytes_ = 0;
  std::vector<std::uint64_t> lost_, dropped_;  // by topic
  std::optional<std::string> request_;
  bool finishing_ = false;
  bool abandoned_ = false;
  RecorderState state_;
  std::thread thread_;
};

}  // namespace sinew::logger
