// Mutated payloads of every topic into a group of participants, cycle by cycle.
//
// First the group runs on well-formed inputs for kWarmUp cycles; what it publishes are seeds too.
// Then episodes: of each topic a writer from outside is silent, sends well-formed payloads, or
// sends mutated ones; the session is the provider's or another. In every cycle all participants
// that have a trigger make their step. What must hold: no exception; what they publish decodes and
// has meaning, is finite, and a motor torque is within the model's limit.
//
// Deterministic by seed, apart from the threads of recorder and nodes. Thread: one.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "bench/payloads/group.h"
#include "bench/payloads/mutator.h"
#include "components/topics/node/node.h"

namespace sinew::payloads {

struct SoakOptions {
  std::uint64_t seed = 1;
  std::string topic;  // mutate this one alone; empty: all
};

struct TopicCount {
  std::string topic;
  std::uint64_t mutated = 0;                  // payloads sent
  std::uint64_t well_formed = 0;              // payloads sent
  int readers = 0;                            // of participants
  std::uint64_t received = 0, malformed = 0;  // by these, mutated or not
};

struct MemberCount {
  std::string name;
  std::uint64_t steps = 0;
  std::uint64_t ended = 0;  // sessions that ended: a last_tick is no fault
};

struct Defect {
  std::string member, what;
  std::uint64_t cycle = 0;  // of the first one
  std::uint64_t times = 0;
};

class Soak {
 public:
  Soak(const Group& group, const SoakOptions& options);
  ~Soak();
  Soak(const Soak&) = delete;
  Soak& operator=(const Soak&) = delete;

  // Until at least so many further mutated payloads were sent, or SIGINT or SIGTERM came, which
  // ends the participants too.
  void Run(std::uint64_t payloads);
  bool stopped() const { return environment_.stop.requested(); }

  std::uint64_t payloads() const { return payloads_; }
  std::uint64_t cycles() const { return cycle_; }
  std::vector<TopicCount> topics() const;
  std::vector<MemberCount> members() const;
  const std::vector<Defect>& defects() const { return defects_; }

 private:
  enum class From { kSilent, kWellFormed, kMutated };
  struct Member {
    MemberSpec spec;
    std::unique_ptr<node::Component> component;
    MemberCount count;
  };
  struct Topic {
    std::vector<node::Bytes> seeds;
    std::size_t most_bytes = 0;
    std::vector<node::RawWriter> writer;  // one
    From from = From::kSilent;
    std::uint64_t mutated = 0, well_formed = 0;
  };

  void WarmUp();
  void StartEpisode();
  void Cycle();
  // True: what it says of session or tick would keep participants from hearing the true ones.
  bool SendTrigger(bool mutated);
  void Send(std::size_t topic, bool mutated);
  void Write(std::size_t topic, const node::Bytes& payload);
  void StepAll();
  void Step(Member* member);
  // A payload that a participant published.
  void Watch(std::size_t topic, const node::Bytes& payload);
  void Report(const std::string& member, const std::string& what);

  const SoakOptions options_;
  Mutator mutator_;
  Environment environment_;
  std::vector<Topic> topics_;
  std::vector<Member> members_;
  std::unique_ptr<node::Node> outside_;  // writes payloads
  std::unique_ptr<node::Node> watch_;    // reads what participants publish
  std::vector<Defect> defects_;
  std::vector<std::vector<node::Bytes>> state_seeds_;  // by robot state and phase
  node::Bytes scratch_;
  std::size_t last_tick_offset_ = 0;
  std::uint64_t payloads_ = 0, cycle_ = 0, session_id_ = 0, left_of_episode_ = 0;
  std::size_t robot_state_ = 1;
  std::string stepping_;  // the participant whose step it is
  bool from_outside_ = false, warm_ = false;
};

}  // namespace sinew::payloads
