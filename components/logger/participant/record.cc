#include "components/logger/participant/record.h"

#include <sinew_idl/recording.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>

#include "components/config/config.h"
#include "components/logger/recorder.h"
#include "components/node/version.h"
#include "components/recording/file/file_io.h"
#include "components/types/clock/utc.h"

namespace sinew::logger {

namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr std::uint64_t kProgressTicks = 16;
constexpr milliseconds kQuiet(500);        // nothing more comes
constexpr milliseconds kLongestEnd(5000);  // for topics that answer every tick
constexpr milliseconds kQuietProgress(5);  // a provider may be waiting

std::vector<const node::TopicInfo*> ChooseTopics(const std::vector<std::string>& names) {
  std::vector<const node::TopicInfo*> topics;
  if (names.empty()) {
    for (const node::TopicInfo& topic : node::AllTopics()) {
      // Its numbers depend on the moment: it would make two equal runs differ.
      if (topic.name != node::kRecordingProgress.name) topics.push_back(&topic);
    }
    return topics;
  }
  for (const std::string& name : names) {
    const node::TopicInfo* topic = node::FindTopic(name);
    if (topic == nullptr) {
      std::string list;
      for (const node::TopicInfo& known : node::AllTopics())
        list += (list.empty() ? "" : ", ") + known.name;
      throw UsageError("--topics: no topic '" + name + "', expected one of: " + list);
    }
    if (std::find(topics.begin(), topics.end(), topic) == topics.end()) topics.push_back(topic);
  }
  return topics;
}

recording::McapMetadata Describe(const node::Options& options,
                                 const std::vector<std::string>& notes) {
  recording::McapMetadata metadata{"sinew.recording", {}};
  for (const std::string& note : notes) {
    const std::size_t equals = note.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw UsageError("--note: '" + note + "', expected KEY=VALUE");
    }
    metadata.values[note.substr(0, equals)] = note.substr(equals + 1);
  }
  char host[64] = {};
  ::gethostname(host, sizeof(host) - 1);
  metadata.values["version"] = node::kVersion;
  metadata.values["topics_hash"] = node::AllTopicsHash();
  metadata.values["domain_id"] = std::to_string(options.domain_id);
  metadata.values["mode"] = options.mode == node::TimeMode::kLockstep ? "lockstep" : "realtime";
  metadata.values["seed"] = std::to_string(options.seed);
  metadata.values["recorder"] = options.name;
  metadata.values["host"] = host;
  metadata.values["started"] = types::UtcNow();
  return metadata;
}

// One recording: topics, recorder, progress, end.
class Session {
 public:
  Session(node::Node& node, const RecordOptions& options)
      : node_(node),
        options_(options),
        lockstep_(node.options().mode == node::TimeMode::kLockstep),
        topics_(ChooseTopics(options.topics)),
        metadata_(Describe(node.options(), options.notes)),  // before the file: it may throw
        sink_(options.out,
              options.overwrite ? recording::Existing::kReplace : recording::Existing::kRefuse),
        progress_writer_(node.MakeWriter(node::kRecordingProgress)) {
    std::vector<recording::TopicSchema> schemas;
    for (const node::TopicInfo* topic : topics_) {
      schemas.push_back({topic->name, topic->type_name, topic->idl, topic->idl_hash});
    }
    RecorderOptions recorder_options;
    recorder_options.wait_for_capacity = lockstep_;
    if (lockstep_) recorder_options.queue_bytes = 64u << 20;
    recorder_ = std::make_shared<Recorder>(sink_, std::move(schemas),
                                           std::vector<recording::McapMetadata>{metadata_},
                                           recorder_options);
    for (std::size_t i = 0; i < topics_.size(); ++i) {
      // The recorder lives as long as DDS may call.
      node_.ReadRaw(*topics_[i], [recorder = recorder_, i](node::RawSample&& sample) {
        (void)recorder->Offer(i, std::move(sample.payload), sample.reception_stamp_ns);
      });
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
      state_ = recorder_->state();
      CheckFile();
      const auto now = Clock::now();
      if (state_.messages != seen_messages_) {
        seen_messages_ = state_.messages;
        last_news_ = now;
      }
      PublishProgress(now);
      ReportDrops(now);
      if (now >= next_report) {
        next_report = now + milliseconds(100);
        node_.SetCounts({state_.messages, 0, 0, state_.dropped});
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
    // What is on its way still belongs to the recording.
    const auto give_up = Clock::now() + kQuiet;
    while (lockstep_ && Clock::now() < give_up && node_.WaitForData(milliseconds(50))) {
    }
    const recording::IoStatus written = recorder_->Finish();
    state_ = recorder_->state();
    CheckFile();
    const recording::IoStatus closed = written.ok() ? sink_.Close() : written;
    if (!closed.ok()) Fail(closed);
    if (state_.session) PublishTick(state_.session->tick + 1);
    if (progress) progress(Result(end));
    node_.SetState(node::Node::State::kStopped, end);
    return Result(end);
  }

 private:
  [[noreturn]] void Fail(const recording::IoStatus& status) {
    const std::string what = options_.out.string() + ": cannot be written: " + status.message() +
                             "; the recording ends after " + std::to_string(state_.messages) +
                             " messages";
    node_.SetState(node::Node::State::kFault, what);
    throw std::runtime_error(what);
  }
  void CheckFile() {
    if (!state_.status.ok()) Fail(state_.status);
  }

  RecordResult Result(const std::string& end) const {
    RecordResult result;
    result.messages = state_.messages;
    result.dropped = state_.dropped;
    result.missing_ticks = state_.missing_ticks;
    result.bytes = state_.bytes;
    result.end = end;
    for (const TopicState& topic : state_.topics) result.topics += topic.messages > 0 ? 1 : 0;
    return result;
  }

  void PublishTick(std::uint64_t tick) {
    msg::RecordingProgress message;
    message.header().session_id(state_.session->session_id);
    message.header().tick(tick);
    message.header().stamp_ns(state_.session->stamp_ns);
    message.header().origin(static_cast<msg::Origin>(state_.session->origin));
    message.recorder(node_.options().name.substr(0, 32));
    message.messages(state_.messages);
    message.bytes(state_.bytes);
    if (progress_writer_.Write(message) != node::WriteStatus::kOk && !reported_unsent_) {
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
    if (state_.dropped == reported_dropped_ || now < next_drop_report_) return;
    spdlog::warn(
        "{} messages did not fit the queue and are not in the recording: the disk is too slow",
        state_.dropped - reported_dropped_);
    reported_dropped_ = state_.dropped;
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
      // Not bound to ticks: status by the clock, states now and then.
      const std::string& name = topics_[i]->name;
      if (name == node::kComponentStatus.name || name == node::kComponentSnapshot.name) continue;
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
  const recording::McapMetadata metadata_;
  recording::FileSink sink_;
  node::Writer<msg::RecordingProgress> progress_writer_;
  std::shared_ptr<Recorder> recorder_;
  RecorderState state_;
  std::uint64_t seen_messages_ = 0;
  Clock::time_point last_news_ = Clock::now();
  Clock::time_point next_drop_report_{};
  std::uint64_t reported_dropped_ = 0;
  std::uint64_t published_session_ = 0;
  std::uint64_t published_tick_ = 0;
  bool reported_unsent_ = false;
  std::optional<Clock::time_point> ended_since_;
};

}  // namespace

void AddRecordOptions(CLI::App& app, RecordOptions* options) {
  app.add_option("--out", options->out, "The recording to write, FILE.mcap")->required();
  app.add_option("--topics", options->topics,
                 "Only these topics (comma or blank between); all by default")
      ->delimiter(',');
  app.add_option("--note", options->notes,
                 "KEY=VALUE for the recording's metadata; may be repeated")
      ->allow_extra_args(false);
  app.add_flag("--overwrite", options->overwrite, "Replace the file if it is there");
  app.add_flag("--keep-going", options->keep_going,
               "Do not end with the session: further sessions go into the same file");
  app.add_option("--duration", options->duration_s,
                 "Seconds to record; until the session ends by default")
      ->check(CLI::NonNegativeNumber);
}

RecordResult Record(node::Node& node, const node::StopFlag& stop, const RecordOptions& options,
                    const std::function<void(const RecordResult&)>& progress) {
  Session session(node, options);
  return session.Run(stop, progress);
}

}  // namespace sinew::logger
