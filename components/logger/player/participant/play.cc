#include "components/logger/player/participant/play.h"

#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <map>
#include <optional>
#include <thread>

#include "components/config/config.h"
#include "components/logger/player/participant/answers.h"
#include "components/logger/player/participant/live_ticks.h"
#include "components/recording/file/file_io.h"

namespace sinew::logger {

namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

constexpr int kUnacknowledged = 192;      // of the 256 samples that lockstep writers keep
constexpr std::uint64_t kLookAhead = 64;  // ticks: topics of a recording are interleaved

std::vector<recording::TopicSchema> KnownTopics() {
  std::vector<recording::TopicSchema> known;
  for (const node::TopicInfo& topic : node::AllTopics()) {
    known.push_back({topic.name, topic.type_name, topic.idl, topic.idl_hash});
  }
  return known;
}

PlaylistOptions WithRemap(const PlayOptions& options) {
  PlaylistOptions list = options.list;
  list.only_when_named.assign(node::kCommandingTopics.begin(), node::kCommandingTopics.end());
  for (const std::string& text : options.remap) {
    const std::size_t colon = text.find(':');
    if (colon == std::string::npos || colon == 0 || colon + 1 == text.size()) {
      throw UsageError("--remap: '" + text + "', expected FROM:TO");
    }
    list.remap[text.substr(0, colon)] = text.substr(colon + 1);
  }
  return list;
}

class Player {
 public:
  Player(node::Node& node, const node::StopFlag& stop, const PlayOptions& options,
         Playlist& playlist)
      : node_(node),
        stop_(stop),
        options_(options),
        playlist_(playlist),
        lockstep_(node.options().mode == node::TimeMode::kLockstep) {
    for (const std::string& name : playlist_.published()) {
      if (name == node::kJointState.name) is_provider_ = true;
    }
    follows_ = options.follow || (lockstep_ && !is_provider_);
    if (follows_ && is_provider_) {
      throw UsageError(
          "--follow: joint_state is to be played, expected --topics without it: who follows "
          "needs a running state provider");
    }
    answers_.emplace(node, stop, options.await, options.wait_timeout_s);
    if (is_provider_) RefuseSecondProvider();
    for (const std::string& name : playlist_.published()) {
      writers_.push_back(node_.MakeRawWriter(*node::FindTopic(name)));
    }
    unacknowledged_.assign(writers_.size(), 0);
    result_.message_count = playlist_.message_count();
  }

  PlayResult Run(const std::function<void(const PlayResult&)>& progress) {
    progress_ = progress;
    node_.SetState(node::Node::State::kConfigured, "waiting for readers");
    if (!WaitForReaders()) return result_;
    node_.SetState(node::Node::State::kActive, "playing " + options_.path.filename().string());
    start_ = Clock::now();
    if (follows_) {
      Follow();
    } else {
      PlayAll();
    }
    for (std::size_t i = 0; i < writers_.size(); ++i) Acknowledge(i);
    result_.wall_s = std::chrono::duration<double>(Clock::now() - start_).count();
    if (progress_) progress_(result_);
    node_.SetState(node::Node::State::kStopped, "end of the recording");
    return result_;
  }

 private:
  void RefuseSecondProvider() {
    const auto end = Clock::now() + milliseconds(lockstep_ ? 300 : 700);
    while (Clock::now() < end && !stop_.requested()) {
      for (const node::Endpoint& endpoint : node_.Endpoints()) {
        if (endpoint.is_writer && endpoint.topic == node::kJointState.name) {
          throw UsageError(
              "domain " + std::to_string(node_.options().domain_id) +
              " already has a state provider: '" + endpoint.participant +
              "'; stop it, use another --domain, or play --topics without joint_state");
        }
      }
      node_.WaitForData(milliseconds(50));
    }
  }

  int Matched() const {
    int matched = 0;
    for (const node::RawWriter& writer : writers_) matched += writer.matched_readers();
    return matched;
  }

  // False: stop was requested.
  bool WaitForReaders() {
    const auto give_up = Clock::now() + std::chrono::duration<double>(options_.wait_timeout_s);
    const int wanted = options_.wait_readers;
    const bool settle = wanted < 0 && lockstep_ && !follows_;
    int matched = -1;
    auto since = Clock::now();
    while (!stop_.requested()) {
      bool ready = true;
      std::string missing;
      for (std::size_t i = 0; i < writers_.size(); ++i) {
        if (writers_[i].matched_readers() < wanted) {
          ready = false;
          missing = playlist_.published()[i];
        }
      }
      if (settle) {  // some reader, and no new one for a while
        const int now_matched = Matched();
        if (now_matched != matched) since = Clock::now();
        matched = now_matched;
        ready = matched > 0 && Clock::now() - since >= milliseconds(300);
        missing = playlist_.published()[0];
      }
      if (ready) return true;
      if (Clock::now() > give_up) {
        throw UsageError("--wait-readers: no " + std::string(settle ? "" : "such number of ") +
                         "readers of topic '" + missing + "' in domain " +
                         std::to_string(node_.options().domain_id) + " within " +
                         std::to_string(static_cast<int>(options_.wait_timeout_s)) +
                         " s; are they running, in the same time mode?");
      }
      node_.WaitForData(milliseconds(20));
    }
    return false;
  }

  void Acknowledge(std::size_t topic) {
    if (unacknowledged_[topic] == 0) return;
    unacknowledged_[topic] = 0;
    const auto give_up = Clock::now() + std::chrono::duration<double>(options_.wait_timeout_s);
    while (!writers_[topic].WaitAcknowledged(milliseconds(200))) {
      if (stop_.requested()) return;
      if (Clock::now() > give_up) {
        throw std::runtime_error("topic '" + playlist_.published()[topic] +
                                 "': a reader took nothing for " +
                                 std::to_string(static_cast<int>(options_.wait_timeout_s)) + " s");
      }
    }
  }

  void Send(const PlayedMessage& message) {
    if (lockstep_ && ++unacknowledged_[message.topic] >= kUnacknowledged) {
      for (std::size_t i = 0; i < writers_.size(); ++i)
        Acknowledge(i);  // together: one wait, not one each
    }
    if (writers_[message.topic](message.payload.data(), message.payload.size()) !=
        node::WriteStatus::kOk) {
      ++result_.write_failures;
    }
    ++result_.messages;
    result_.recorded_s = static_cast<double>(message.due_ns) * 1e-9;
    const auto now = Clock::now();
    if (now < next_report_) return;
    next_report_ = now + milliseconds(100);
    result_.wall_s = std::chrono::duration<double>(now - start_).count();
    node_.SetCounts({result_.messages, 0, 0, result_.write_failures});
    if (progress_) progress_(result_);
  }

  void PlayAll() {
    const double rate = options_.rate >= 0.0 ? options_.rate : lockstep_ ? 0.0 : 1.0;
    PlayedMessage message;
    while (!stop_.requested() && playlist_.Next(&message)) {
      if (rate > 0.0) {
        const auto due =
            start_ +
            nanoseconds(static_cast<std::int64_t>(static_cast<double>(message.due_ns) / rate));
        while (Clock::now() < due && !stop_.requested()) {
          std::this_thread::sleep_until(std::min(due, Clock::now() + milliseconds(50)));
        }
      }
      if (message.is_state && !answers_->WaitBefore(message)) return;
      Send(message);
    }
  }

  void Follow() {
    LiveTicks live(node_);
    std::multimap<std::uint64_t, PlayedMessage> waiting;  // by tick since the recording's first
    std::optional<std::uint64_t> first_recorded;
    std::uint64_t newest = 0;
    bool more = true;
    std::optional<LiveTick> first;
    const auto give_up = Clock::now() + std::chrono::duration<double>(options_.wait_timeout_s);
    while (!stop_.requested()) {
      const std::optional<LiveTick> tick = live.TakeNext();
      if (!tick) {
        if (!first && Clock::now() > give_up) {
          throw UsageError("--follow: no joint_state in domain " +
                           std::to_string(node_.options().domain_id) +
                           ", expected a running state provider");
        }
        node_.WaitForData(milliseconds(50));
        continue;
      }
      if (first && tick->session_id != first->session_id) return;  // its session is over
      if (!first) first = tick;
      const std::uint64_t index = tick->tick - first->tick;
      while (more && (!first_recorded || newest < index + kLookAhead)) {
        PlayedMessage message;
        more = playlist_.Next(&message);
        if (!more) break;
        if (!first_recorded) first_recorded = message.tick;
        const std::uint64_t at =
            message.tick >= *first_recorded ? message.tick - *first_recorded : 0;
        newest = std::max(newest, at);
        waiting.emplace(at, std::move(message));
      }
      while (!waiting.empty() && waiting.begin()->first <= index) {
        PlayedMessage message = std::move(waiting.begin()->second);
        const bool due = waiting.begin()->first == index;
        waiting.erase(waiting.begin());
        if (!due) continue;  // its tick was missed
        playlist_.Retarget(&message, tick->session_id, tick->tick, tick->stamp_ns);
        Send(message);
      }
      if (tick->last) return;
      if (!more && waiting.empty()) {
        spdlog::warn("the recording ends at tick {} of the running session", tick->tick);
        return;
      }
    }
  }

  node::Node& node_;
  const node::StopFlag& stop_;
  const PlayOptions& options_;
  Playlist& playlist_;
  const bool lockstep_;
  bool is_provider_ = false;
  bool follows_ = false;
  std::vector<node::RawWriter> writers_;
  std::vector<int> unacknowledged_;
  std::optional<Answers> answers_;
  PlayResult result_;
  std::function<void(const PlayResult&)> progress_;
  Clock::time_point start_{};
  Clock::time_point next_report_{};
};

}  // namespace

void AddPlayOptions(CLI::App& app, PlayOptions* options) {
  app.add_option("recording", options->path, "The recording, FILE.mcap")->required();
  app.add_option("--topics", options->list.topics,
                 "Only these topics (comma or blank between); by default all but component_status, "
                 "recording_progress and those that command (joint_command, reference, ...)")
      ->delimiter(',');
  app.add_option("--remap", options->remap,
                 "FROM:TO, publish a topic under the name of another of its type")
      ->delimiter(',');
  app.add_option("--rate", options->rate,
                 "Times real time; 0: as fast as it goes (the default in lockstep)")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--start", options->list.start_s, "Seconds into the recording")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--end", options->list.end_s, "Seconds into the recording")
      ->check(CLI::NonNegativeNumber);
  app.add_flag(
      "--follow", options->follow,
      "Stand in for components of a running session: send what was recorded at tick k at its k-th "
      "tick (the default in lockstep without joint_state)");
  app.add_option("--wait-readers", options->wait_readers,
                 "Readers every topic must have before it begins")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--wait-timeout", options->wait_timeout_s,
                 "Seconds to wait for readers, answers or a session")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--await", options->await,
                 "Lockstep, with joint_state: TOPIC or TOPIC:WINDOW that must answer a tick before "
                 "the next")
      ->delimiter(',');
}

PlayResult Play(node::Node& node, const node::StopFlag& stop, const PlayOptions& options,
                const std::function<void(const PlayResult&)>& progress) {
  const PlaylistOptions list = WithRemap(options);
  recording::FileSource source(options.path);
  try {
    const recording::McapReader reader(source);
    if (reader.recovery()) {
      spdlog::warn("{}: was cut off; {} messages in {} bytes are whole ({})", options.path.string(),
                   reader.recovery()->messages, reader.recovery()->good_bytes,
                   reader.recovery()->reason);
    }
    Playlist playlist(reader, options.path.string(), KnownTopics(), list);
    for (const std::string& topic : playlist.left_out()) {
      spdlog::warn("{}: topic '{}' is not known to this build and not played",
                   options.path.string(), topic);
    }
    for (const std::string& topic : playlist.not_named()) {
      spdlog::info("topic '{}' commands and is not played: name it with --topics to play it",
                   topic);
    }
    Player player(node, stop, options, playlist);
    return player.Run(progress);
  } catch (const recording::McapError& error) {
    throw UsageError(options.path.string() + ": " + error.what());
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
}

}  // namespace sinew::logger
