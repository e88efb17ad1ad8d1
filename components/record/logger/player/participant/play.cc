#include "components/record/logger/player/participant/play.h"

#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>

#include "components/base/config/config.h"
#include "components/base/types/text.h"
#include "components/record/logger/player/control_socket.h"
#include "components/record/logger/player/pace.h"
#include "components/record/logger/player/participant/answers.h"
#include "components/record/recording/cdr.h"
#include "components/record/recording/file/file_io.h"
#include "components/record/recording/idl_schema.h"
#include "components/topics/node/codec.h"
#include "components/topics/node/endpoint.h"
#include "components/topics/node/node.h"
#include "components/topics/node/time_option.h"

namespace sinew::logger {

namespace {

struct LiveTick {
  std::uint64_t session_id;
  std::uint64_t tick;
  std::int64_t stamp_ns;
  bool last;  // the session ends with it
};

// The ticks of a running session, from its joint_state. Threads: DDS appends, the player's takes.
class LiveTicks {
 public:
  // Reads joint_state from here on.
  explicit LiveTicks(node::Node& node) {
    const node::TopicInfo& info = *node::FindTopic(node::kJointState.name);
    const auto idl = std::make_shared<recording::IdlSchema>(recording::IdlSchema::Parse(info.idl));
    const recording::IdlType& type = idl->Struct(info.type_name);
    const recording::CdrField stamp(type, "header.stamp_ns");
    const recording::CdrField last(type, "last_tick");
    node.ReadRaw(info, [live = shared_, idl, stamp, last](node::RawSample&& sample) {
      node::HeadOfMessage head;
      if (!node::PeekHead(sample.payload.data(), sample.payload.size(), &head)) return;
      try {
        const LiveTick tick{head.session_id, head.tick, stamp.AsInt(sample.payload),
                            last.AsInt(sample.payload) != 0};
        const std::lock_guard<std::mutex> lock(live->mutex);
        live->ticks.push_back(tick);
      } catch (const recording::CdrError&) {
      }
    });
  }
  // The oldest.
  std::optional<LiveTick> TakeNext() {
    const std::lock_guard<std::mutex> lock(shared_->mutex);
    if (shared_->ticks.empty()) return std::nullopt;
    const LiveTick tick = shared_->ticks.front();
    shared_->ticks.pop_front();
    return tick;
  }

 private:
  struct Shared {
    std::mutex mutex;
    std::deque<LiveTick> ticks;
  };
  const std::shared_ptr<Shared> shared_ = std::make_shared<Shared>();
};

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

constexpr int kUnacknowledged = 192;      // of the 256 samples that lockstep writers keep
constexpr std::uint64_t kLookAhead = 64;  // ticks: topics of a recording are interleaved
// Discovery takes some announcements (every 500 ms, qos_profiles.xml); a reader that is there is
// seen by then, and a player in an empty domain need not wait for ever.
constexpr milliseconds kWithoutReaders(2000);
// Between looks at the stop flag, which wakes nobody.
constexpr milliseconds kLook(50);

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
  for (const node::TopicInfo& topic : node::AllTopics()) {
    if (topic.profile == node::Profile::kLatched) list.latched.push_back(topic.name);
  }
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
         Playlist& playlist, PlayControl& control)
      : node_(node),
        stop_(stop),
        options_(options),
        playlist_(playlist),
        control_(control),
        lockstep_(node.options().mode == node::TimeMode::kLockstep),
        pace_(options.rate >= 0.0 ? options.rate
              : lockstep_         ? kMaxRate
                                  : 1.0) {
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
    result_.message_count = playlist_.message_count() * options.loop;
    playlist_.BeginPass(0, 0, options.loop == 1);
    if (options.paused) pace_.Pause(0);
    try {
      socket_.emplace(PlayerSocket(node.options().domain_id, node.options().name), control);
    } catch (const UsageError& error) {
      spdlog::warn("no remote control: {}", error.what());
    }
  }

  PlayResult Run(const std::function<void(const PlayResult&)>& progress) {
    progress_ = progress;
    node_.SetState(node::Node::State::kConfigured, "waiting for readers");
    if (!WaitForReaders()) return result_;
    node_.SetState(node::Node::State::kActive, "playing " + options_.path.filename().string());
    start_ = Clock::now();
    pace_.JumpTo(pace_.PositionAt(0), 0);
    if (follows_) {
      Follow();
    } else {
      PlayAll();
    }
    for (std::size_t i = 0; i < writers_.size(); ++i) Acknowledge(i);
    result_.wall_s = std::chrono::duration<double>(Clock::now() - start_).count();
    result_.status = Status();
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
    const auto begin = Clock::now();
    const auto give_up = begin + std::chrono::duration<double>(options_.wait_timeout_s);
    const int wanted = options_.wait_readers;
    const bool settle = wanted < 0 && !follows_;
    int matched = -1;
    auto since = begin;
    waiting_ = true;
    while (!stop_.requested() && !quit_) {
      TakeRequests();
      Report();
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
        if (matched == 0 && !lockstep_) ready = Clock::now() - begin >= kWithoutReaders;
        missing = playlist_.published()[0];
      }
      if (ready) {
        waiting_ = false;
        return true;
      }
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
    if (last_due_ns_ && message.due_ns > *last_due_ns_) {
      result_.recorded_s += static_cast<double>(message.due_ns - *last_due_ns_) * 1e-9;
    }
    last_due_ns_ = message.due_ns;
    last_session_ = message.session_id;
    last_tick_ = message.tick;
    Report();
  }

  void Report() {
    const auto now = Clock::now();
    if (now < next_report_) return;
    next_report_ = now + milliseconds(100);
    result_.wall_s = waiting_ ? 0.0 : std::chrono::duration<double>(now - start_).count();
    result_.status = Status();
    node_.SetCounts({result_.messages, 0, 0, result_.write_failures});
    if (progress_) progress_(result_);
  }

  // Time on the clock of pace_.
  std::int64_t Wall() const {
    return waiting_ ? 0 : std::chrono::nanoseconds(Clock::now() - start_).count();
  }

  PlayStatus Status() const {
    PlayStatus status;
    const std::int64_t position = follows_ ? last_due_ns_.value_or(0) : pace_.PositionAt(Wall());
    status.duration_s = static_cast<double>(playlist_.duration_ns()) * 1e-9;
    status.position_s = std::min(static_cast<double>(position) * 1e-9, status.duration_s);
    status.rate = pace_.rate();
    status.paused = pace_.paused();
    status.waiting = waiting_;
    status.pass = pass_;
    status.messages = result_.messages;
    status.session_id = last_session_;
    status.tick = last_tick_;
    return status;
  }

  void TakeRequests() {
    PlayRequest request;
    while (control_.Next(&request)) {
      const std::string refusal = CarryOut(request);
      control_.Reply(refusal.empty() ? "ok " + FormatPlayStatus(Status()) : "error " + refusal);
      next_report_ = {};  // shown at once
    }
  }

  // Why not; empty: done.
  std::string CarryOut(const PlayRequest& request) {
    using Kind = PlayRequest::Kind;
    const std::int64_t wall = Wall();
    if (request.kind == Kind::kStatus) return "";
    if (request.kind == Kind::kQuit) {
      quit_ = true;
      return "";
    }
    if (follows_) return "the player follows a running session, whose ticks set the pace";
    const double position_s = static_cast<double>(pace_.PositionAt(wall)) * 1e-9;
    switch (request.kind) {
      case Kind::kToggle:
        if (pace_.paused()) {
          pace_.Resume(wall);
        } else {
          pace_.Pause(wall);
        }
        return "";
      case Kind::kPause:
        pace_.Pause(wall);
        return "";
      case Kind::kResume:
        pace_.Resume(wall);
        return "";
      case Kind::kStep:
        if (waiting_) return "step: waiting for readers";
        pace_.Pause(wall);
        return Step(request.ticks) ? "" : "step: the recording has ended";
      case Kind::kSeek:
        return Seek(request.seconds);
      case Kind::kSeekBy:
        return Seek(std::clamp(position_s + request.seconds, 0.0, Status().duration_s));
      case Kind::kRate:
        pace_.SetRate(request.rate, wall);
        return "";
      case Kind::kFaster:
        pace_.SetRate(FasterRate(pace_.rate()), wall);
        return "";
      case Kind::kSlower:
        pace_.SetRate(SlowerRate(pace_.rate()), wall);
        return "";
      default:
        return "";
    }
  }

  std::string Seek(double seconds) {
    const double duration_s = static_cast<double>(playlist_.duration_ns()) * 1e-9;
    if (!(seconds >= 0.0 && seconds <= duration_s)) {
      return types::Text("seek: %.3f s, expected 0 to %.3f", seconds, duration_s);
    }
    BeginPass(static_cast<std::int64_t>(std::llround(seconds * 1e9)));
    return "";
  }

  void BeginPass(std::int64_t position_ns) {
    playlist_.BeginPass(++pass_, position_ns, options_.loop == loops_ + 1);
    has_next_ = false;
    last_due_ns_.reset();
    pace_.JumpTo(position_ns, Wall());
  }

  // False: the end, of all loops.
  bool Fetch() {
    if (has_next_) return true;
    has_next_ = playlist_.Next(&next_);
    if (has_next_ || loops_ + 1 == options_.loop) return has_next_;
    ++loops_;
    BeginPass(0);
    has_next_ = playlist_.Next(&next_);
    return has_next_;
  }

  // The message at hand begins another tick than the last one's: with joint_state it is one.
  bool BeginsTick() const {
    if (is_provider_) return next_.is_state;
    return next_.session_id != last_session_ || next_.tick > last_tick_ || !last_due_ns_;
  }

  // Plays what is left of this tick, and so many whole ones. False: nothing was left.
  bool Step(std::uint64_t ticks) {
    bool any = false, tick_begun = false;
    while (!stop_.requested() && Fetch()) {
      if (BeginsTick()) {
        if (tick_begun && --ticks == 0) return true;
        tick_begun = true;
      }
      any = true;
      if (!SendNext()) return true;
    }
    return any;
  }

  // False: stop was requested.
  bool SendNext() {
    if (next_.is_state && !answers_->WaitBefore(next_)) return false;
    has_next_ = false;
    Send(next_);
    if (pace_.paused() || pace_.rate() == kMaxRate) pace_.JumpTo(next_.due_ns, Wall());
    return true;
  }

  void PlayAll() {
    while (!stop_.requested() && !quit_) {
      TakeRequests();
      if (quit_ || !Fetch()) return;
      const std::int64_t wall = Wall();
      const std::optional<std::int64_t> due = pace_.DueAt(next_.due_ns, wall);
      if (!due || *due > wall) {
        Report();
        const nanoseconds look(kLook);
        control_.WaitForRequest(due ? std::min(look, nanoseconds(*due - wall)) : look);
      } else if (!SendNext()) {
        return;
      }
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
    while (!stop_.requested() && !quit_) {
      TakeRequests();
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
  PlayControl& control_;
  const bool lockstep_;
  bool is_provider_ = false;
  bool follows_ = false;
  Pace pace_;  // its wall clock begins with start_
  PlayedMessage next_;
  bool has_next_ = false, waiting_ = true, quit_ = false;
  std::uint64_t pass_ = 0, loops_ = 0;       // passes begun, whole loops done
  std::optional<std::int64_t> last_due_ns_;  // of this pass
  std::uint64_t last_session_ = 0, last_tick_ = 0;
  std::vector<node::RawWriter> writers_;
  std::vector<int> unacknowledged_;
  std::optional<Answers> answers_;
  PlayResult result_;
  std::function<void(const PlayResult&)> progress_;
  Clock::time_point start_{};
  Clock::time_point next_report_{};
  std::optional<ControlSocket> socket_;  // last: it ends first
};

void ReadRate(PlayOptions* options, const std::string& text) {
  if (text == "max" || text == "0") {
    options->rate = kMaxRate;
    return;
  }
  const PlayRequest request = [&text] {
    try {
      return ParsePlayRequest("rate " + text);
    } catch (const std::invalid_argument&) {
      throw CLI::ValidationError("--rate",
                                 "'" + text + "', expected a number of at least 0.1, or max");
    }
  }();
  options->rate = request.rate;
}

}  // namespace

void AddPlayOptions(CLI::App& app, PlayOptions* options) {
  app.add_option("recording", options->path, "The recording, FILE.mcap")->required();
  app.add_option("--topics", options->list.topics,
                 "Only these topics (regular expressions of whole names, comma or blank between); "
                 "by default all but component_status, log, recording_progress and those that "
                 "command (joint_command, reference, ...), which must be named in full")
      ->type_name("TOPIC")
      ->delimiter(',');
  app.add_option("--exclude", options->list.exclude,
                 "Not these topics (regular expressions as with --topics)")
      ->type_name("TOPIC")
      ->delimiter(',');
  app.add_option("--remap", options->remap,
                 "FROM:TO, publish a topic under the name of another of its type")
      ->delimiter(',');
  app.add_option_function<std::string>(
      "--rate", [options](const std::string& text) { ReadRate(options, text); },
      "Times real time, from 0.1; max: as fast as it goes (the default in lockstep)");
  app.add_option("--loop", options->loop,
                 "Play it so many times, each as a new session; 0: until it is stopped")
      ->capture_default_str();
  app.add_flag("--paused", options->paused, "Start paused");
  app.add_option("--start", options->list.start_s, "Seconds into the recording")
      ->check(node::IsTime(node::Zero::kAllowed));
  app.add_option("--end", options->list.end_s, "Seconds into the recording")
      ->check(node::IsTime(node::Zero::kAllowed));
  app.add_flag(
      "--follow", options->follow,
      "Stand in for components of a running session: send what was recorded at tick k at its k-th "
      "tick (the default in lockstep without joint_state)");
  app.add_option("--wait-readers", options->wait_readers,
                 "Readers every topic must have before it begins; by default some reader of any "
                 "topic, which real time waits for at most 2 s")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--wait-timeout", options->wait_timeout_s,
                 "Seconds to wait for readers, answers or a session")
      ->check(node::IsTime(node::Zero::kRefused))
      ->capture_default_str();
  app.add_option("--await", options->await,
                 "Lockstep, with joint_state: TOPIC or TOPIC:WINDOW that must answer a tick before "
                 "the next")
      ->delimiter(',');
}

PlayResult Play(node::Node& node, const node::StopFlag& stop, const PlayOptions& options,
                PlayControl& control, const std::function<void(const PlayResult&)>& progress) {
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
    recording::LeftOut left_out = playlist.not_readable();
    for (const std::string& topic : playlist.left_out()) {
      left_out.emplace(topic, "topic '" + topic + "' is not known to this build");
    }
    if (!left_out.empty()) {
      spdlog::warn("{}", recording::LeftOutText(options.path.string(), left_out));
    }
    for (const std::string& topic : playlist.not_named()) {
      spdlog::info("topic '{}' commands and is not played: name it with --topics to play it",
                   topic);
    }
    Player player(node, stop, options, playlist, control);
    return player.Run(progress);
  } catch (const recording::McapError& error) {
    throw UsageError(options.path.string() + ": " + error.what());
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
}

}  // namespace sinew::logger
