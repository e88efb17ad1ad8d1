#include "bench/payloads/soak.h"

#include <sinew_idl/joint.h>
#include <time.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "bench/payloads/seeds.h"
#include "bench/payloads/watch.h"
#include "components/topics/node/topics.h"

// Half of the time would go into pages of freed memory and into stacks of calls.
extern "C" const char* __asan_default_options();   // NOLINT(bugprone-reserved-identifier)
extern "C" const char* __asan_default_options() {  // NOLINT(bugprone-reserved-identifier)
  return "quarantine_size_mb=16:malloc_context_size=3";
}

namespace sinew::payloads {
namespace {

constexpr std::uint64_t kWarmUp = 600;
constexpr std::size_t kMostSeeds = 64;
constexpr std::size_t kRobotStates = 5;
constexpr std::size_t kArmed = 1;
// A session ends once in so many payloads that say so: each makes every participant anew.
constexpr std::size_t kEndsKept = 200;
// Of a topic in a cycle; the queue of a state holds 8 samples.
constexpr std::size_t kMostBurst = 6;
// Of one step: longer is a loop over something that a message claims. Processor time: a busy
// machine may take longer.
constexpr double kLongestStep_s = 2.0;

double ProcessorTime_s() {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

bool IsInputOfWarmUp(std::string_view topic) {
  return topic == node::kActuatorState.name || topic == node::kSimTruth.name;
}

}  // namespace

Soak::Soak(const Group& group, const SoakOptions& options)
    : options_(options), mutator_(options.seed), last_tick_offset_(LastTickOffset()) {
  if (!options.topic.empty()) (void)IndexOf(options.topic);
  for (std::size_t state = 0; state < kRobotStates; ++state) {
    state_seeds_.emplace_back();
    for (std::size_t phase = 0; phase < kPhases; ++phase) {
      state_seeds_.back().push_back(JointStateSeed(phase, state));
    }
  }
  const auto node_of = [this](const char* name) {
    node::Options of_node;
    of_node.component = of_node.name = name;
    of_node.composition = &environment_.composition;
    return std::make_unique<node::Node>(of_node);
  };
  outside_ = node_of("outside");
  watch_ = node_of("watch");
  std::vector<std::vector<node::Bytes>> seeds = HandmadeSeeds();
  for (std::size_t i = 0; i < node::AllTopics().size(); ++i) {
    const node::TopicInfo& topic = node::AllTopics()[i];
    topics_.push_back({.seeds = std::move(seeds[i]),
                       .most_bytes = node::MaxEncodedSize(topic.type_name),
                       .writer = {outside_->MakeRawWriter(topic)}});
    watch_->ReadRaw(topic, [this, i](node::RawSample&& sample) { Watch(i, sample.payload); });
  }
  for (const MemberSpec& spec : group.members) {
    members_.push_back(
        {.spec = spec, .component = Make(spec, environment_), .count = {.name = spec.name}});
  }
  WarmUp();
}

Soak::~Soak() { members_.clear(); }

void Soak::WarmUp() {
  warm_ = true;
  session_id_ = environment_.provider_session;
  robot_state_ = kArmed;
  for (std::uint64_t n = 0; n < kWarmUp; ++n) {
    environment_.tick = ++cycle_;
    for (std::size_t i = 0; i < topics_.size(); ++i) {
      if (IsInputOfWarmUp(node::AllTopics()[i].name)) Send(i, false);
    }
    (void)SendTrigger(false);
    StepAll();
  }
  warm_ = false;
}

void Soak::Run(std::uint64_t payloads) {
  const std::uint64_t goal = payloads_ + payloads;
  while (payloads_ < goal && !stopped()) Cycle();
}

void Soak::StartEpisode() {
  left_of_episode_ = mutator_.OneIn(8) ? 2000 : 50 + mutator_.Below(350);
  session_id_ = mutator_.OneIn(2) ? mutator_.Random() : environment_.provider_session;
  robot_state_ = mutator_.OneIn(4) ? mutator_.Below(kRobotStates) : kArmed;
  for (std::size_t i = 0; i < topics_.size(); ++i) {
    const std::size_t drawn = mutator_.Below(4);
    topics_[i].from = drawn == 0 ? From::kSilent : drawn == 1 ? From::kWellFormed : From::kMutated;
    const std::string& name = node::AllTopics()[i].name;
    if (name == node::kJointState.name && drawn == 0) topics_[i].from = From::kMutated;
    const bool only = !options_.topic.empty();
    if (only && name == options_.topic) topics_[i].from = From::kMutated;
    if (only && name != options_.topic && topics_[i].from == From::kMutated) {
      topics_[i].from = From::kWellFormed;
    }
  }
}

void Soak::Cycle() {
  if (left_of_episode_ == 0) StartEpisode();
  --left_of_episode_;
  environment_.tick = ++cycle_;
  for (std::size_t i = 0; i < topics_.size(); ++i) {
    if (node::AllTopics()[i].name == node::kJointState.name) continue;
    if (topics_[i].from == From::kWellFormed) Send(i, false);
    if (topics_[i].from != From::kMutated) continue;
    for (std::size_t n = 1 + mutator_.Below(kMostBurst); n > 0; --n) Send(i, true);
    if (mutator_.OneIn(2)) Send(i, false);  // the newest: what follows works on good values
  }
  const bool mutated = topics_[IndexOf(node::kJointState.name)].from == From::kMutated;
  if (SendTrigger(mutated && mutator_.OneIn(2))) left_of_episode_ = 0;
  StepAll();
}

void Soak::Send(std::size_t topic, bool mutated) {
  Topic& of = topics_[topic];
  scratch_ = of.seeds[mutated ? mutator_.Below(of.seeds.size()) : cycle_ % of.seeds.size()];
  if (node::AllTopics()[topic].name != node::kComponentStatus.name) {
    const bool to_provider = mutator_.OneIn(4);
    SetHead(to_provider ? environment_.provider_session : session_id_,
            mutator_.OneIn(4) ? environment_.tick - 1 : environment_.tick, &scratch_);
  }
  if (mutated) mutator_.Mutate(of.most_bytes, &scratch_);
  ++(mutated ? of.mutated : of.well_formed);
  if (mutated) ++payloads_;
  Write(topic, scratch_);
}

bool Soak::SendTrigger(bool mutated) {
  const std::size_t index = IndexOf(node::kJointState.name);
  scratch_ = state_seeds_[robot_state_][cycle_ % kPhases];
  SetHead(session_id_, environment_.tick, &scratch_);
  bool jumps = false;
  if (mutated) {
    mutator_.Mutate(topics_[index].most_bytes, &scratch_);
    if (scratch_.size() > last_tick_offset_ && scratch_[last_tick_offset_] != std::byte{0} &&
        !mutator_.OneIn(kEndsKept)) {
      scratch_[last_tick_offset_] = std::byte{0};
    }
    thread_local msg::JointState state;
    jumps = node::Decode(scratch_, &state) && state.header.session_id == session_id_ &&
            state.header.tick > environment_.tick;
  }
  ++(mutated ? topics_[index].mutated : topics_[index].well_formed);
  if (mutated) ++payloads_;
  Write(index, scratch_);
  return jumps;
}

void Soak::Write(std::size_t topic, const node::Bytes& payload) {
  from_outside_ = true;
  (void)topics_[topic].writer.front()(payload.data(), payload.size());
  from_outside_ = false;
}

void Soak::StepAll() {
  for (Member& member : members_) Step(&member);
}

void Soak::Step(Member* member) {
  stepping_ = member->spec.name;
  const double begin_s = ProcessorTime_s();
  bool goes_on = true;
  try {
    if (!member->component->Ready()) return;
    ++member->count.steps;
    goes_on = member->component->Step();
    if (!goes_on) ++member->count.ended;
  } catch (const std::exception& error) {
    Report(member->spec.name, error.what());
    goes_on = false;
  }
  if (ProcessorTime_s() - begin_s > kLongestStep_s) {
    Report(member->spec.name, "a step of seconds");
  }
  if (goes_on) return;
  member->component.reset();  // before its successor: it stands for the same name
  member->component = Make(member->spec, environment_);
}

void Soak::Watch(std::size_t topic, const node::Bytes& payload) {
  if (from_outside_) return;
  const std::string& name = node::AllTopics()[topic].name;
  if (const std::string wrong = Assess(name, payload); !wrong.empty()) {
    Report(stepping_, "publishes in " + name + " " + wrong);
  }
  if (!warm_) return;
  std::vector<node::Bytes>& seeds = topics_[topic].seeds;
  if (seeds.size() < kMostSeeds) {
    seeds.push_back(payload);
  } else {
    seeds[cycle_ % kMostSeeds] = payload;
  }
}

void Soak::Report(const std::string& member, const std::string& what) {
  for (Defect& defect : defects_) {
    if (defect.member != member || defect.what != what) continue;
    ++defect.times;
    return;
  }
  defects_.push_back({.member = member, .what = what, .cycle = cycle_, .times = 1});
}

std::vector<TopicCount> Soak::topics() const {
  std::vector<TopicCount> counts;
  counts.reserve(topics_.size());
  for (std::size_t i = 0; i < topics_.size(); ++i) {
    const std::string& name = node::AllTopics()[i].name;
    const node::Composition::Taken taken = environment_.composition.taken(name);
    counts.push_back({.topic = name,
                      .mutated = topics_[i].mutated,
                      .well_formed = topics_[i].well_formed,
                      .readers = taken.readers - 1,  // the watch
                      .received = taken.received,
                      .malformed = taken.malformed});
  }
  return counts;
}

std::vector<MemberCount> Soak::members() const {
  std::vector<MemberCount> counts;
  counts.reserve(members_.size());
  for (const Member& member : members_) counts.push_back(member.count);
  return counts;
}

}  // namespace sinew::payloads
