#include "components/record/logger/participant/record.h"

#include <sinew_idl/recording.h>
#include <sinew_idl/snapshot.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <memory>
#include <utility>

#include "components/base/types/seconds.h"
#include "components/record/logger/file/file_series.h"
#include "components/record/logger/participant/description.h"
#include "components/record/logger/participant/topic_choice.h"
#include "components/record/logger/recorder.h"

namespace sinew::logger {

namespace {

std::atomic<bool> dump_requested{false};
static_assert(std::atomic<bool>::is_always_lock_free, "it is set in a signal handler");

void RequestDump(int) { dump_requested.store(true, std::memory_order_relaxed); }

// SIGUSR1 as a request to write what a ring holds. One object at a time; any thread asks it.
class DumpSignal {
 public:
  // From here on the signal does not end the process.
  DumpSignal() {
    struct sigaction action {};
    action.sa_handler = &RequestDump;
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    ::sigaction(SIGUSR1, &action, &before_);
  }
  ~DumpSignal() { ::sigaction(SIGUSR1, &before_, nullptr); }  // what was before
  DumpSignal(const DumpSignal&) = delete;
  DumpSignal& operator=(const DumpSignal&) = delete;

  // Whether the signal came since the last call.
  static bool Take() noexcept { return dump_requested.exchange(false); }

 private:
  struct sigaction before_ {};
};

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr std::uint64_t kProgressTicks = 16;
constexpr milliseconds kQuiet(500);        // nothing more comes
constexpr milliseconds kLongestEnd(5000);  // for topics that answer every tick
constexpr milliseconds kQuietProgress(5);  // a provider may be waiting

RecorderOptions OptionsOf(const RecordOptions& options, bool lockstep) {
  RecorderOptions out;
  out.wait_for_capacity = lockstep;
  out.read_on_after_error = lockstep;  // the provider waits for recording_progress
  out.files.compression = options.compression;
  out.files.split_bytes = options.split_bytes;
  out.files.split_span = types::ToNanoseconds(options.split_s);
  // Simulated time can be recorded again.
  out.files.sync_span = std::chrono::duration_cast<milliseconds>(
      types::ToNanoseconds(options.sync_s.value_or(lockstep ? 0.0 : 1.0)));
  out.ring.last = types::ToNanoseconds(options.last_s);
  out.ring.after = types::ToNanoseconds(options.after_s);
  out.ring.on_fault = options.on_fault;
  // While a ring is written, samples go on to come.
  if (lockstep || options.last_s > 0.0) out.queue_bytes = 64u << 20;
  return out;
}

bool IsNumbered(const RecordOptions& options) {
  return options.split_bytes > 0 || options.split_s > 0.0 || options.last_s > 0.0;
}

// Status and requests stay valid until the next one, everything else is sent every cycle.
Repeats RepeatsOf(const node::TopicInfo& topic) {
  if (topic.name == node::kLog.name) return Repeats::kNoSession;
  if (topic.profile == node::Profile::kLatched) return Repeats::kOfLiveWriters;
  if (topic.profile != node::Profile::kEvent) return Repeats::kNothing;
  // An operator's order counts once: arming is not in force later, and nobody may send it again. A
  // state of an earlier cycle does not fit the inputs of this file: it is asked for anew.
  for (const auto& no_request : {node::kOperatorCommand.name, node::kComponentSnapshot.name,
                                 node::kSnapshotRequest.name, node::kRecordingProgress.name}) {
    if (topic.name == no_request) return Repeats::kNothing;
  }
  return Repeats::kOfTheSession;
}

// Requests to all components for their states, at the beginning of every file but the first (to
// which a recorder that comes and a session that begins bring them), and twice in the span of a
// ring, so that the ring holds a state of its first half.
class SnapshotRequests {
 public:
  SnapshotRequests(node::Node& node, std::chrono::nanoseconds ring)
      : writer_(node.MakeWriter(node::kSnapshotRequest)), ring_(ring), last_(Clock::now()) {}

  void Tend(const RecorderState& state, Clock::time_point now) {
    const bool file = state.files > files_ && state.files > 1;
    const bool half = ring_.count() > 0 && now - last_ >= ring_ / 2;
    if (!state.session || (!file && !half)) return;
    files_ = state.files;
    last_ = now;
    msg::SnapshotRequest request;
    request.header.session_id = state.session->session_id;
    request.header.tick = state.session->tick;
    request.header.stamp_ns = state.session->stamp_ns;
    request.header.origin = static_cast<msg::Origin>(state.session->origin);
    request.after_tick = state.session->tick + kAhead_ticks;
    if (writer_.Write(request) != node::WriteStatus::kOk && !std::exchange(reported_, true)) {
      spdlog::warn("snapshot_request could not be sent: files lack the states of components");
    }
  }

 private:
  // A state needs the inputs of its tick and of the one before in the same file, and topics come
  // at their own pace: in lockstep the state provider, and with it everybody, is this far ahead of
  // the joint_state that is written (recording_progress:64, tools/launch); in real time by less.
  // The first tick that is surely in the file, and the next one.
  static constexpr std::uint64_t kAhead_ticks = 64 + 2;

  node::Writer<msg::SnapshotRequest> writer_;
  const std::chrono::nanoseconds ring_;
  int files_ = 0;  // begun at the last request
  Clock::time_point last_;
  bool reported_ = false;
};

// DDS may call for as long as the node lives: what it calls owns the files too.
struct OpenRecording {
  OpenRecording(const RecordOptions& options, const std::vector<recording::TopicSchema>& schemas,
                const std::vector<recording::McapMetadata>& metadata,
                const RecorderOptions& recorder_options)
      : files(options.out, IsNumbered(options),
              options.overwrite ? recording::Existing::kReplace : recording::Existing::kRefuse),
        recorder(files, schemas, metadata, recorder_options) {}

  FileSeries files;
  Recorder recorder;
};

// Nothing where DDS security refuses it and nobody waits for it: an observer records in real time.
std::optional<node::Writer<msg::RecordingProgress>> ProgressWriter(node::Node& node) {
  try {
    return node.MakeWriter(node::kRecordingProgress);
  } catch (const node::DdsError& refused) {
    if (node.options().mode == node::TimeMode::kLockstep) throw;
    spdlog::info("recorded without recording_progress: {}", refused.what());
    return std::nullopt;
  }
}

// One recording: topics, recorder, progress, end.
class Session {
 public:
  Session(node::Node& node, const RecordOptions& options)
      : node_(node),
        options_(options),
        lockstep_(node.options().mode == node::TimeMode::kLockstep),
        topics_(ChooseTopics(options.topics, options.exclude)),
        progress_writer_(ProgressWriter(node)) {
    if (options.last_s > 0.0) dump_signal_.emplace();
    std::vector<recording::TopicSchema> schemas;
    for (const node::TopicInfo* topic : topics_) {
      schemas.push_back({topic->name, topic->type_name, topic->idl, topic->idl_hash});
      const bool snapshots = topic->name == node::kComponentSnapshot.name;
      if (snapshots && IsNumbered(options))
        snapshots_.emplace(node, types::ToNanoseconds(options.last_s));
    }
    Description description = Describe(node.options(), options.notes, options.attach);
    RecorderOptions recorder_options = OptionsOf(options, lockstep_);
    recorder_options.files.attachments = std::move(description.attachments);
    recorder_options.files.describe_writer = [&node](const WriterGuid& writer) {
      return DescribeWriter(node, writer);
    };
    if (IsNumbered(options)) {
      for (const node::TopicInfo* topic : topics_) {
        recorder_options.files.repeats.push_back(RepeatsOf(*topic));
      }
    }
    recorder_options.files.writer_is_live = [&node](const WriterGuid& writer) {
      return node.NameOf(writer).has_value();
    };
    open_ =
        std::make_shared<OpenRecording>(options, schemas, description.metadata, recorder_options);
    for (std::size_t i = 0; i < topics_.size(); ++i) {
      // One of several writers of an EXCLUSIVE topic is heard: the numbers of the others have gaps.
      const bool exclusive = node::IsExclusive(topics_[i]->profile);
      // In real time this thread looks after the recording now and then; a wake-up for each sample
      // would cost more than the recording.
      node_.ReadRaw(
          *topics_[i],
          [open = open_, i, exclusive](node::RawSample&& sample) {
            (void)open->recorder.Offer(i, std::move(sample.payload), sample.reception_stamp_ns,
                                       {sample.writer, exclusive ? 0 : sample.sequence});
          },
          /*wakes=*/lockstep_);
    }
  }

  RecordResult Run(const node::StopFlag& stop,
                   const std::function<void(const RecordResult&)>& progress) {
    node_.SetState(node::Node::State::kActive, "recording " + options_.out.filename().string());
    const auto start = Clock::now();
    auto next_report = start;
    std::string end;
    while (end.empty()) {
      node_.WaitForData(lockstep_ ? kQuietProgress : milliseconds(50));
      state_ = open_->recorder.state();
      CheckFile();
      const auto now = Clock::now();
      if (dump_signal_ && DumpSignal::Take()) open_->recorder.Trigger("SIGUSR1");
      if (state_.messages != seen_messages_) {
        seen_messages_ = state_.messages;
        last_news_ = now;
      }
      PublishProgress(now);
      if (snapshots_) snapshots_->Tend(state_, now);
      ReportDrops(now);
      if (now >= next_report) {
        next_report = now + milliseconds(100);
        node_.SetCounts({state_.messages, 0, 0, state_.losses.dropped});
        CountLost();
        ReportTriggers();
        if (progress) progress(Result(""));
      }
      if (stop.requested()) {
        end = "stopped";
      } else if (options_.duration_s > 0.0 &&
                 now - start >= std::chrono::duration<double>(options_.duration_s)) {
        end = "duration is over";
      } else if (!options_.keep_going && SessionEnded(now)) {
        end = "session ended";
      }
    }
    // Samples that are on their way still belong to the recording.
    const auto give_up = Clock::now() + kQuiet;
    while (lockstep_ && Clock::now() < give_up && node_.WaitForData(milliseconds(50))) {
    }
    CountLost();
    const recording::IoStatus written = open_->recorder.Finish();
    state_ = open_->recorder.state();
    if (!written.ok()) Fail();
    ReportTriggers();
    if (state_.session) PublishTick(state_.session->tick + 1);
    if (progress) progress(Result(end));
    node_.SetState(node::Node::State::kStopped, end);
    return Result(end);
  }

 private:
  std::string Failure() const {
    return open_->files.current().string() + ": cannot be written: " + state_.status.message() +
           "; the recording ends after " + std::to_string(state_.written) + " messages";
  }
  [[noreturn]] void Fail() {
    node_.SetState(node::Node::State::kFault, Failure());
    throw std::runtime_error(Failure());
  }
  // A robot in real time does not need this process. In lockstep the provider waits for it: it
  // answers until the session ends, and fails then.
  void CheckFile() {
    if (state_.status.ok()) return;
    if (!lockstep_) Fail();
    if (failed_) return;
    failed_ = true;
    node_.SetState(node::Node::State::kFault, Failure());
    spdlog::error("{}; recording_progress goes on without it", Failure());
  }

  void CountLost() {
    for (std::size_t i = 0; i < topics_.size(); ++i) {
      open_->recorder.SetLost(i, node_.RawLost(topics_[i]->name));
    }
  }

  void ReportTriggers() {
    if (state_.triggers == reported_triggers_) return;
    reported_triggers_ = state_.triggers;
    spdlog::warn("{}: the last {} s and {} s more are written ({})",
                 open_->files.current().string(), options_.last_s, options_.after_s,
                 state_.last_trigger);
    if (state_.ring_forgotten == 0) return;
    spdlog::warn("{} messages were too many for {} MiB of memory: less than {} s were kept",
                 state_.ring_forgotten, RingOptions{}.bytes >> 20, options_.last_s);
  }

  RecordResult Result(const std::string& end) const {
    RecordResult result;
    result.messages = state_.written;
    result.dropped = state_.losses.dropped;
    result.lost = state_.losses.lost;
    result.missing = state_.losses.missing;
    result.files = state_.files;
    result.triggers = state_.triggers;
    result.missing_ticks = state_.missing_ticks;
    result.bytes = state_.bytes;
    result.end = end;
    for (const TopicState& topic : state_.topics) result.topics += topic.messages > 0 ? 1 : 0;
    return result;
  }

  void PublishTick(std::uint64_t tick) {
    if (!progress_writer_) return;
    msg::RecordingProgress message;
    message.header.session_id = state_.session->session_id;
    message.header.tick = tick;
    message.header.stamp_ns = state_.session->stamp_ns;
    message.header.origin = static_cast<msg::Origin>(state_.session->origin);
    message.recorder = node_.options().name.substr(0, 32);
    message.messages = state_.messages;
    message.bytes = state_.bytes;
    if (progress_writer_->Write(message) != node::WriteStatus::kOk && !reported_unsent_) {
      reported_unsent_ = true;
      spdlog::warn("recording_progress could not be sent");
    }
    published_session_ = state_.session->session_id;
    published_tick_ = tick;
  }

  // Header tick T says: every joint_state before T is written.
  void PublishProgress(Clock::time_point now) {
    if (!state_.session) return;
    const std::uint64_t tick = state_.session->tick + 1;
    const bool other = state_.session->session_id != published_session_;
    if (!other && tick <= published_tick_) return;
    const bool quiet = now - last_news_ >= kQuietProgress;
    const std::uint64_t step = lockstep_ ? kProgressTicks : 240;
    if (other || quiet || state_.session->last_tick || tick >= published_tick_ + step)
      PublishTick(tick);
  }

  void ReportDrops(Clock::time_point now) {
    if (state_.losses.dropped == reported_dropped_ || now < next_drop_report_) return;
    spdlog::warn(
        "{} messages did not fit the queue and are not in the recording: the disk is too slow",
        state_.losses.dropped - reported_dropped_);
    reported_dropped_ = state_.losses.dropped;
    next_drop_report_ = now + milliseconds(1000);
  }

  bool SessionEnded(Clock::time_point now) {
    if (!state_.session || !state_.session->last_tick) {
      ended_since_.reset();
      return false;
    }
    if (!ended_since_) ended_since_ = now;
    const std::uint64_t last = state_.session->tick;
    bool all_there = true;
    bool regular_missing = false;
    for (std::size_t i = 0; i < topics_.size(); ++i) {
      const TopicState& topic = state_.topics[i];
      if (topic.messages == 0 || topic.session_id != state_.session->session_id ||
          topic.tick >= last)
        continue;
      // Not bound to ticks: status by the clock, states and lines of logs now and then.
      const std::string& name = topics_[i]->name;
      if (name == node::kComponentStatus.name || name == node::kComponentSnapshot.name ||
          name == node::kSnapshotRequest.name || name == node::kLog.name) {
        continue;
      }
      all_there = false;
      // A topic that answered nearly every tick will answer the last ones too.
      regular_missing = regular_missing || 10 * topic.messages >= 9 * (last + 1);
    }
    if (all_there) return true;
    const bool quiet = now - last_news_ >= kQuiet;
    return quiet && (!regular_missing || now - *ended_since_ >= kLongestEnd);
  }

  node::Node& node_;
  const RecordOptions& options_;
  const bool lockstep_;
  std::vector<const node::TopicInfo*> topics_;
  std::optional<node::Writer<msg::RecordingProgress>> progress_writer_;
  std::optional<SnapshotRequests> snapshots_;  // of numbered files
  std::optional<DumpSignal> dump_signal_;      // of a ring
  std::shared_ptr<OpenRecording> open_;
  RecorderState state_;
  std::uint64_t seen_messages_ = 0;
  Clock::time_point last_news_ = Clock::now();
  Clock::time_point next_drop_report_{};
  std::uint64_t reported_dropped_ = 0;
  int reported_triggers_ = 0;
  bool failed_ = false;  // lockstep: the file could not be written any more
  std::uint64_t published_session_ = 0;
  std::uint64_t published_tick_ = 0;
  bool reported_unsent_ = false;
  std::optional<Clock::time_point> ended_since_;
};

}  // namespace

RecordResult Record(node::Node& node, const node::StopFlag& stop, const RecordOptions& options,
                    const std::function<void(const RecordResult&)>& progress) {
  Session session(node, options);
  return session.Run(stop, progress);
}

}  // namespace sinew::logger
