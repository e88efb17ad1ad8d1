#include "components/logger/player/participant/play.h"

#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <chrono>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "components/config/config.h"
#include "components/node/codec.h"
#include "components/recording/file/file_io.h"

namespace sinew::logger {

namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

constexpr int kUnacknowledged = 192;  // of the 256 samples that lockstep writers keep
constexpr int kLongestWindow = 128;
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
  for (const std::string& text : options.remap) {
    const std::size_t colon = text.find(':');
    if (colon == std::string::npos || colon == 0 || colon + 1 == text.size()) {
      throw UsageError("--remap: '" + text + "', expected FROM:TO");
    }
    list.remap[text.substr(0, colon)] = text.substr(colon + 1);
  }
  return list;
}

// Replies that bound how far the player runs ahead.
struct Awaited {
  std::string topic;
  std::size_t window = 0;
  std::shared_ptr<std::atomic<std::uint64_t>> answered;  // newest tick + 1
  std::shared_ptr<std::atomic<std::uint64_t>> session;
};

// What a running session's joint_state says; written by the DDS thread.
struct LiveState {
  std::mutex mutex;
  struct Tick {
    std::uint64_t session_id;
    std::uint64_t tick;
    std::int64_t stamp_ns;
    bool last;
  };
  std::deque<Tick> ticks;
};

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
    for (const std::string& text : options.await) AddAwaited(text);
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
  void AddAwaited(const std::string& text) {
    Awaited awaited;
    const std::size_t colon = text.find(':');
    awaited.topic = text.substr(0, colon);
    const node::TopicInfo* topic = node::FindTopic(awaited.topic);
    if (topic == nullptr) throw UsageError("--await: no topic '" + awaited.topic + "'");
    if (colon != std::string::npos) {
      int window = -1;
      try {
        window = std::stoi(text.substr(colon + 1));
      } catch (const std::exception&) {
      }
      if (window < 0 || window > kLongestWindow) {
        throw UsageError("--await: '" + text +
                         "', expected TOPIC:WINDOW with a window from 0 to 128 ticks");
      }
      awaited.window = static_cast<std::size_t>(window);
    }
    awaited.answered = std::make_shared<std::atomic<std::uint64_t>>(0);
    awaited.session = std::make_shared<std::atomic<std::uint64_t>>(0);
    node_.ReadRaw(
        *topic, [answered = awaited.answered, session = awaited.session](node::RawSample&& sample) {
          node::HeadOfMessage head;
          if (!node::PeekHead(sample.payload.data(), sample.payload.size(), &head)) return;
          answered->store(0);
          session->store(head.session_id);
          answered->store(head.tick + 1);
        });
    awaited_.push_back(std::move(awaited));
  }

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

  // Before a joint_state goes out: the tick `window` ticks before its forerunner must be answered.
  bool AwaitAnswers(const PlayedMessage& next) {
    if (awaited_.empty()) return true;
    if (!sent_ticks_.empty() && sent_session_ != next.session_id) sent_ticks_.clear();
    sent_session_ = next.session_id;
    for (const Awaited& awaited : awaited_) {
      if (sent_ticks_.size() <= awaited.window) continue;
      const std::uint64_t tick = sent_ticks_[sent_ticks_.size() - 1 - awaited.window];
      const auto give_up = Clock::now() + std::chrono::duration<double>(options_.wait_timeout_s);
      while (awaited.session->load() != next.session_id || awaited.answered->load() < tick + 1) {
        if (stop_.requested()) return false;
        node_.WaitForData(milliseconds(50));
        if (Clock::now() > give_up) {
          throw std::runtime_error(
              "no " + awaited.topic + " for tick " + std::to_string(tick) + " within " +
              std::to_string(static_cast<int>(options_.wait_timeout_s)) +
              " s; is its writer running, in the same domain and in lockstep?");
        }
      }
    }
    sent_ticks_.push_back(next.tick);
    if (sent_ticks_.size() > kLongestWindow + 2) sent_ticks_.pop_front();
    return true;
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
      if (message.is_state && !AwaitAnswers(message)) return;
      Send(message);
    }
  }

  void Follow() {
    auto live = std::make_shared<LiveState>();
    const node::TopicInfo& info = *node::FindTopic(node::kJointState.name);
    const auto idl = std::make_shared<recording::IdlSchema>(recording::IdlSchema::Parse(info.idl));
    const recording::IdlType& type = idl->Struct(info.type_name);
    const recording::CdrField stamp(type, "header.stamp_ns");
    const recording::CdrField last(type, "last_tick");
    node_.ReadRaw(info, [live, idl, stamp, last](node::RawSample&& sample) {
      node::HeadOfMessage head;
      if (!node::PeekHead(sample.payload.data(), sample.payload.size(), &head)) return;
      try {
        const LiveState::Tick tick{head.session_id, head.tick, stamp.AsInt(sample.payload),
                                   last.AsInt(sample.payload) != 0};
        const std::lock_guard<std::mutex> lock(live->mutex);
        live->ticks.push_back(tick);
      } catch (const recording::CdrError&) {
      }
    });

    std::multimap<std::uint64_t, PlayedMessage> waiting;  // by tick since the recording's first
    std::optional<std::uint64_t> first_recorded;
    std::uint64_t newest = 0;
    bool more = true;
    std::optional<LiveState::Tick> first;
    const auto give_up = Clock::now() + std::chrono::duration<double>(options_.wait_timeout_s);
    while (!stop_.requested()) {
      std::optional<LiveState::Tick> tick;
      {
        const std::lock_guard<std::mutex> lock(live->mutex);
        if (!live->ticks.empty()) {
          tick = live->ticks.front();
          live->ticks.pop_front();
        }
      }
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
  std::vector<Awaited> awaited_;
  std::deque<std::uint64_t> sent_ticks_;
  std::uint64_t sent_session_ = 0;
  PlayResult result_;
  std::function<void(const PlayResult&)> progress_;
  Clock::time_point start_{};
  Clock::time_point next_report_{};
};

}  // namespace

void AddPlayOptions(CLI::App& app, PlayOptions* options) {
  app.add_option("recording", options->path, "The recording, FILE.mcap")->required();
  app.add_option("--topics", options->list.topics,
                 "Only these topics (comma or blank between); all but component_status and "
                 "recording_progress by default")
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
    Player player(node, stop, options, playlist);
    return player.Run(progress);
  } catch (const recording::McapError& error) {
    throw UsageError(options.path.string() + ": " + error.what());
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
}

}  // namespace sinew::logger
