// A DDS domain in which one program is tested: plays the robot for it and hears its outputs.
//
// Real time: ticks come at a fixed rate, whatever the program does. Lockstep: a tick ends when
// every topic that the role must write has answered, or with a timeout.
//
// Threads: one thread; outputs are copied by DDS threads. Throws node::DdsError.
#pragma once

#include <sinew_idl/operator.h>
#include <sinew_idl/status.h>

#include <chrono>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "components/topics/node/endpoint.h"
#include "components/topics/node/node.h"
#include "tools/conform/facts.h"
#include "tools/conform/robot.h"
#include "tools/conform/role.h"

namespace sinew::conform {

using StageClock = std::chrono::steady_clock;

struct StageOptions {
  int domain_id = 0;
  node::TimeMode mode = node::TimeMode::kRealtime;
  double rate_Hz = 240.0;
  std::string subject;  // the name of the program under test
};

struct Output {
  std::optional<Facts> facts;  // empty: no message of the topic
  std::size_t size = 0;        // bytes of the payload
  double latency_s = 0.0;  // since joint_state of its tick was sent; 0: of no tick of the window
  bool early = false;      // of the played session_id, but of a tick that was not asked for yet
};

// Ticks that were played, and the outputs that came back.
struct Window {
  std::uint64_t session_id = 0, first_tick = 0;
  int ticks = 0;
  std::map<std::string, std::vector<Output>> outputs;  // by topic

  // Outputs that belong to a tick of the window.
  std::vector<const Output*> Of(const std::string& topic) const;
  int Answered(const std::string& topic) const;  // ticks with an output
};

class Stage {
 public:
  Stage(const Role& role, StageOptions options);

  const StageOptions& options() const { return options_; }
  node::Node& node() { return node_; }

  // Plays ticks like this moment, from the session's next tick on.
  Window Play(const Moment& like, int ticks);
  // The same until the condition holds; false: it did not within the limit.
  bool PlayUntil(const Moment& like, const std::function<bool()>& condition,
                 std::chrono::milliseconds limit);
  // Waits without ticks.
  bool WaitUntil(const std::function<bool()>& condition, std::chrono::microseconds limit);
  // The period that ticks have and say, from the next one on.
  void SetRate(double rate_Hz);
  // Ticks of another session count from 0.
  void StartSession(std::uint64_t session_id);
  std::uint64_t session_id() const { return session_id_; }

  // Also plays the topics of the role itself, as the owner that is there when the program starts.
  // Waits until it has settled: a process that gets the role before that may have its strength.
  void PlayOwner();  // throws std::runtime_error: it has not settled in time
  // Strength of the played owner's writer of the topic; 0 when it is not played.
  std::uint32_t OwnerStrength(std::string_view topic) const;
  void EndOwner();

  void Send(msg::OperatorAction action, const std::string& target = "");
  // The topic's message of the next tick is sent as this function gives it.
  using Damaging = std::function<node::Bytes(const node::Bytes&)>;
  void Damage(const std::string& topic, Damaging damaging);

  // Status of the program under test; nothing: not seen yet.
  std::optional<msg::ComponentStatus> status();
  std::vector<node::Endpoint> SubjectEndpoints() const;
  bool SubjectReads(std::string_view topic) const;
  bool SubjectWrites(std::string_view topic) const;
  // A topic that the role must write and the subject's writer of it match.
  bool IsHeard(const std::string& topic) const;
  // Participants that are neither this one nor the subject.
  std::vector<std::string> Strangers() const;

 private:
  struct Heard {
    std::string topic;
    node::Bytes payload;
    StageClock::time_point at;
  };
  void OnSample(node::RawSample&& sample);
  Window PlayTicks(const Moment& like, int ticks, std::chrono::milliseconds last_answer);
  void PublishTick(const Moment& like);
  // Sorts what has arrived into the window.
  void Collect(Window* window);
  bool AllAnswered(const Window& window, std::uint64_t tick) const;
  void Read(const node::TopicInfo& topic);

  const Role role_;
  const StageOptions options_;
  std::mutex mutex_;
  std::vector<Heard> heard_;  // guarded by mutex_; node_'s threads write it, so it outlives them
  node::Node node_;
  node::Reader<msg::ComponentStatus> statuses_;
  node::Writer<msg::OperatorCommand> operator_;
  std::map<std::string, node::RawWriter> writers_, owners_;
  std::optional<msg::ComponentStatus> status_;

  double rate_Hz_;
  std::uint64_t session_id_ = 1, next_tick_ = 0;
  std::map<std::uint64_t, StageClock::time_point> sent_;  // of the session's ticks
  StageClock::time_point due_ = StageClock::now();
  std::map<std::string, Damaging> damaged_;  // for the next tick
  bool valve_open_ = false;
};

}  // namespace sinew::conform
