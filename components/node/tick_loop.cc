#include "components/node/tick_loop.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "components/node/all_messages.h"
#include "components/node/command_gate.h"
#include "components/node/cut_off.h"
#include "components/node/input_queue.h"
#include "components/node/node_impl.h"
#include "components/node/other_owner.h"
#include "components/node/replay_gate.h"
#include "components/node/tick_period.h"
#include "components/types/command_rule.h"
#include "components/wire/wire.h"

namespace sinew::node {

using Clock = std::chrono::steady_clock;
using internal::InputQueue;

namespace internal {

// An input without its type: a DDS reader and the samples that it gave, by tick.
class InputBase {
 public:
  InputBase(std::unique_ptr<ReaderImpl> reader, InputRules rules)
      : queue(rules, reader->queue_limit), reader_(std::move(reader)) {}
  virtual ~InputBase() = default;

  // Moves what DDS has received into the queue: all of a trigger.
  void CollectAll() {
    Collect([](const HeadOfMessage&, const WriterId&) { return true; });
  }
  // Only what belongs to the session, and of a commanding topic what the rule admits.
  void Collect(const types::RunningSession& running) {
    Collect([&](const HeadOfMessage& head, const WriterId& writer) {
      if (!commands_) return head.session_id == running.session_id;
      const types::MessageHeader header{
          .session_id = head.session_id,
          .tick = head.tick,
          .origin = wire::FromWire(static_cast<msg::Origin>(head.origin))};
      const types::CommandRefusal refusal =
          types::RefusalOf(types::CommandKind::kRequest, header, running);
      // Everybody's reference is heard: another one's ends a permission.
      const bool permitted = replay && replay->Admits(writer);
      const bool replayed =
          refusal == types::CommandRefusal::kOrigin && header.origin == types::Origin::kReplay;
      if (!replay || !replayed) {
        return gate_.Admits(types::CommandKind::kRequest, header, running);
      }
      if (!permitted) gate_.Refuse(replay->Refusal(writer));
      return permitted;
    });
  }
  // Live hardware has no permission any more for what was taken by one: it never came.
  void ForgetReplay(const types::RunningSession& running) {
    if (!replay || running.origin != types::Origin::kLive || replay->holds()) return;
    if (queue.accepted() && origin() == msg::ORIGIN_REPLAY) queue.Reset();
  }
  // The value counts as live.
  bool replay_permitted() const {
    return replay && replay->holds() && queue.accepted() && origin() == msg::ORIGIN_REPLAY;
  }
  // Sleeps until a sample of this input arrives or the timeout is over.
  void Wait(std::chrono::microseconds timeout) { reader_->WaitForSample(timeout); }

  const std::string& topic() const { return reader_->topic.name; }
  std::uint64_t dropped() const { return reader_->dropped() + queue.dropped(); }
  // False: malformed, and the last value stays.
  virtual bool DecodeValue(const Bytes& bytes) = 0;
  virtual msg::Origin origin() const = 0;  // of the value
  // Of a trigger: what its message says of the cycle.
  virtual void Describe(Tick* tick) const = 0;
  virtual bool robot_may_move() const = 0;  // of a trigger

  std::optional<ReplayGate> replay;  // of a reference, in real time

  InputQueue queue;
  const InputQueue::Decode decode = [this](const Bytes& bytes) {
    if (DecodeValue(bytes)) return true;
    reader_->CountMalformed();
    return false;
  };
  std::uint64_t malformed() const { return reader_->malformed(); }
  std::uint64_t refused() const { return gate_.refused(); }

 private:
  template <class Admits>
  void Collect(const Admits& admits) {
    while (auto sample = reader_->TakeNext()) {
      HeadOfMessage head;
      if (!PeekHead(sample->bytes.data(), sample->bytes.size(), &head)) {
        reader_->CountMalformed();
        continue;
      }
      if (!admits(head, sample->writer)) continue;
      queue.Push(head, std::move(sample->bytes), sample->writer);
    }
  }

  std::unique_ptr<ReaderImpl> reader_;
  CommandGate gate_{topic()};
  const bool commands_ = std::find(kCommandingTopics.begin(), kCommandingTopics.end(), topic()) !=
                         kCommandingTopics.end();
};

}  // namespace internal

using internal::InputBase;

namespace {

// A cycle as long as that controls nothing: who claims more is not understood.
constexpr double kLongestPeriod_s = 10.0;

// A period that a message claims is no reason to wait for more than a second, or to overflow.
std::chrono::nanoseconds BoundedPeriod(double nominal_period_s) {
  const double period_s = nominal_period_s > 0.0 ? std::min(nominal_period_s, 1.0) : 0.0;
  return std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 * period_s));
}

// Of an owner, after which readers hear the next one, in whole periods: a tick is any number that a
// message claims. Without a period: 0.
std::uint64_t PeriodsOfSilence(double nominal_period_s) {
  const std::chrono::nanoseconds period = BoundedPeriod(nominal_period_s);
  if (period.count() == 0) return 0;
  return static_cast<std::uint64_t>(internal::Deadline(period) / period);
}

}  // namespace

bool StillOwner(std::uint64_t owner_tick, const Tick& tick) {
  return owner_tick >= tick.tick ||
         tick.tick - owner_tick <= PeriodsOfSilence(tick.nominal_period_s);
}

template <class Message>
struct TickInput<Message>::State final : public InputBase {
  using InputBase::InputBase;
  Message message, next;

  bool DecodeValue(const Bytes& bytes) override {
    if (!Decode(bytes, &next)) return false;
    if constexpr (std::is_same_v<Message, msg::JointState>) {
      // Every participant divides by it or makes filters of it.
      if (!(next.period_s() > 0.0 && next.period_s() <= kLongestPeriod_s)) return false;
    }
    std::swap(message, next);
    return true;
  }
  bool robot_may_move() const override {
    if constexpr (std::is_same_v<Message, msg::JointState>) {
      return types::MayMove(wire::FromWire(message.robot_state()));
    }
    return false;
  }
  msg::Origin origin() const override { return message.header().origin(); }
  void Describe(Tick* tick) const override {
    tick->stamp_ns = message.header().stamp_ns();
    tick->origin = static_cast<int>(origin());
    if constexpr (std::is_same_v<Message, msg::JointState>) {
      tick->nominal_period_s = message.period_s();
      tick->last = message.last_tick();
    }
  }
};

template <class Message>
bool TickInput<Message>::has_value() const {
  return state_->queue.accepted();
}
template <class Message>
const Message& TickInput<Message>::value() const {
  return state_->message;
}
template <class Message>
bool TickInput<Message>::fresh() const {
  return state_->queue.fresh();
}
template <class Message>
bool TickInput<Message>::writer_changed() const {
  return state_->queue.writer_changed();
}
template <class Message>
std::uint64_t TickInput<Message>::tick() const {
  return state_->queue.accepted_tick();
}
template <class Message>
std::uint64_t TickInput<Message>::dropped() const {
  return state_->dropped();
}
template <class Message>
std::uint64_t TickInput<Message>::malformed() const {
  return state_->malformed();
}

template <class Message>
std::uint64_t TickInput<Message>::refused() const {
  return state_->refused();
}

struct TickLoop::Impl {
  Node& node;
  StopFlag& stop;
  const TickLoopOptions options;
  const bool lockstep;
  const double cut_off_share;  // of the nominal period
  internal::Status& status;
  std::vector<std::shared_ptr<InputBase>> inputs;  // the first one is the trigger
  std::vector<std::shared_ptr<void>> handles;      // TickInput objects given out
  Node::Counts counts;
  TickPeriod period;
  std::uint64_t session_id = 0;
  types::RunningSession running;  // as the trigger's last message says
  std::optional<std::uint64_t> last_tick;
  bool ended = false;
  std::optional<HeadOfMessage> begun{};  // the trigger of the next cycle, accepted

  // A trigger must say how long a cycle is, itself or in the options.
  void CheckTrigger(std::string_view topic, bool carries_period, const InputRules& rules) const {
    const std::string what = "loop with the trigger '" + std::string(topic) + "': ";
    if (rules.delay_ticks != 0) {
      throw std::invalid_argument(what + "delay of " + std::to_string(rules.delay_ticks) +
                                  " ticks, expected 0");
    }
    if (carries_period) return;
    if (!(options.nominal_period_s > 0.0) || !std::isfinite(options.nominal_period_s)) {
      throw std::invalid_argument(what + "it carries no period, and nominal_period_s is " +
                                  std::to_string(options.nominal_period_s) +
                                  ", expected more than 0");
    }
  }

  // The head of the next trigger sample, when there is one; it is the oldest of the queue.
  std::optional<HeadOfMessage> NextTrigger() {
    InputBase& trigger = *inputs.front();
    trigger.CollectAll();
    if (!lockstep) trigger.queue.DropAllButNewest();
    while (const auto head = trigger.queue.front()) {
      const bool seen = last_tick && head->session_id == session_id && head->tick <= *last_tick;
      if (!seen) return head;
      trigger.queue.DropFront();
    }
    return std::nullopt;
  }

  // A trigger sample that means something has come; malformed ones make no cycle.
  bool AcceptTrigger() {
    InputBase& trigger = *inputs.front();
    while (!begun) {
      const auto head = NextTrigger();
      if (!head) return false;
      if (trigger.queue.AcceptFront(trigger.decode)) begun = head;
    }
    return true;
  }

  // Nothing: stop was requested.
  std::optional<HeadOfMessage> WaitForTrigger() {
    while (!AcceptTrigger()) {
      if (stop.requested()) return std::nullopt;
      inputs.front()->Wait(std::chrono::milliseconds(50));
      status.Beat();
    }
    return std::exchange(begun, std::nullopt);
  }

  void StartSession(const HeadOfMessage& head) {
    session_id = head.session_id;
    last_tick.reset();
    for (std::size_t i = 1; i < inputs.size(); ++i) inputs[i]->queue.Reset();
  }

  // Until the sample of the tick is here, or in real time the deadline. False: stop was requested.
  bool WaitForInput(InputBase& input, std::uint64_t tick, Clock::time_point deadline) {
    using std::chrono::microseconds;
    input.Collect(running);
    while (input.queue.rules().required && !input.queue.Reached(tick)) {
      if (stop.requested()) return false;
      const auto left = std::chrono::duration_cast<microseconds>(deadline - Clock::now());
      if (!lockstep && left.count() <= 0) break;
      input.Wait(lockstep ? microseconds(std::chrono::milliseconds(50)) : left);
      status.Beat();
      input.Collect(running);
    }
    return true;
  }

  // The owner of a topic that has been silent for longer than its readers wait was replaced.
  bool WasSilent(const HeadOfMessage& head, const Tick& tick) const {
    if (lockstep || !last_tick || BoundedPeriod(tick.nominal_period_s).count() == 0) return false;
    return head.tick - *last_tick > PeriodsOfSilence(tick.nominal_period_s);
  }

  std::chrono::nanoseconds CutOff(double nominal_period_s) const {
    return std::chrono::nanoseconds(static_cast<std::int64_t>(
        cut_off_share * static_cast<double>(BoundedPeriod(nominal_period_s).count())));
  }

  void Count(const Tick& tick) {
    if (last_tick && tick.tick > *last_tick + 1) counts.missed_ticks += tick.tick - *last_tick - 1;
    if (tick.any_stale) ++counts.stale_inputs;
    ++counts.cycles;
  }
};

TickLoop::TickLoop(Node& node, StopFlag& stop, TickLoopOptions options)
    : impl_(new Impl{.node = node,
                     .stop = stop,
                     .options = options,
                     .lockstep = node.options().mode == TimeMode::kLockstep,
                     .cut_off_share = node.options().composition != nullptr ? 0.0
                                      : options.cut_off_share > 0.0
                                          ? options.cut_off_share
                                          : CutOffOf(node.options().component).share,
                     .status = node.impl_->status,
                     .inputs = {},
                     .handles = {},
                     .counts = {},
                     .period = {},
                     .running = {},
                     .last_tick = {}}) {}

TickLoop::~TickLoop() = default;

template <class Message>
requires kBeginsWithHeader<Message> TickInput<Message>
&TickLoop::AddInput(const Topic<Message>& topic, InputRules rules) {
  if (impl_->inputs.empty()) {
    impl_->CheckTrigger(topic.name, std::is_same_v<Message, msg::JointState>, rules);
  }
  auto reader = std::make_unique<internal::ReaderImpl>(impl_->node.impl_, *FindTopic(topic.name));
  auto input = std::make_shared<TickInput<Message>>();
  input->state_ = std::make_shared<typename TickInput<Message>::State>(std::move(reader), rules);
  if (!impl_->lockstep && !impl_->inputs.empty() && topic.name == kReference.name) {
    input->state_->replay.emplace(impl_->node, impl_->node.impl_);
  }
  impl_->inputs.push_back(input->state_);
  impl_->handles.push_back(input);
  return *input;
}

bool TickLoop::Ready() { return !impl_->ended && impl_->AcceptTrigger(); }

std::optional<Tick> TickLoop::Next() {
  Impl& self = *impl_;
  if (self.ended) {
    self.node.SetState(Node::State::kStopped, "session ended");
    return std::nullopt;
  }
  InputBase& trigger = *self.inputs.front();
  if (!self.last_tick && self.counts.cycles == 0) {
    self.node.SetState(Node::State::kConfigured, "waiting for " + trigger.topic());
  }
  const std::optional<HeadOfMessage> head = self.WaitForTrigger();
  if (!head) return std::nullopt;
  if (!self.last_tick || head->session_id != self.session_id) self.StartSession(*head);

  Tick tick;
  tick.session_id = head->session_id;
  tick.tick = head->tick;
  tick.nominal_period_s = self.options.nominal_period_s;
  trigger.Describe(&tick);
  self.running = {tick.session_id, wire::FromWire(trigger.origin())};
  const auto deadline = Clock::now() + self.CutOff(tick.nominal_period_s);
  bool replayed = false;
  for (std::size_t i = 1; i < self.inputs.size(); ++i) {
    InputBase& input = *self.inputs[i];
    if (input.replay) input.replay->Cycle(self.running, trigger.robot_may_move());
    if (!self.WaitForInput(input, head->tick, deadline)) return std::nullopt;
    input.queue.Accept(head->tick, self.lockstep, input.decode);
    const InputRules& rules = input.queue.rules();
    const bool expected = head->tick >= static_cast<std::uint64_t>(rules.delay_ticks);
    tick.any_stale |= rules.required && expected && !input.queue.fresh();
    input.ForgetReplay(self.running);
    const bool permitted = self.running.origin == types::Origin::kLive && input.replay_permitted();
    tick.replay_permitted |= permitted;
    replayed |= input.queue.accepted() && input.origin() == msg::ORIGIN_REPLAY && !permitted;
  }
  const double period_s = self.period.Next(tick.session_id, tick.tick, tick.stamp_ns,
                                           tick.origin == msg::ORIGIN_SIM, tick.nominal_period_s);
  tick.period_s = self.lockstep ? tick.nominal_period_s : period_s;
  // What is computed from a recording is no live command, whatever triggered it.
  if (replayed) tick.origin = msg::ORIGIN_REPLAY;

  if (tick.nominal_period_s > 0.0) self.node.SetPeriod(BoundedPeriod(tick.nominal_period_s));
  if (self.WasSilent(*head, tick)) self.node.impl_->ownership.StepBelow();
  self.node.impl_->ownership.SetCycle(tick.session_id, static_cast<int>(trigger.origin()));
  self.Count(tick);
  self.last_tick = tick.tick;
  self.ended = tick.last;
  self.node.SetCycle(tick.session_id, tick.tick, tick.stamp_ns, tick.origin);
  if (self.counts.cycles == 1) self.node.SetState(Node::State::kActive);
  if (!self.lockstep || (self.counts.cycles & 63u) == 0) self.node.SetCounts(self.counts);
  return tick;
}

template <class Message>
requires kBeginsWithHeader<Message>
void TickLoop::Publish(Writer<Message>& writer, Message message, const Tick& tick) {
  message.header().session_id(tick.session_id);
  message.header().tick(tick.tick);
  message.header().stamp_ns(tick.stamp_ns);
  message.header().origin(static_cast<msg::Origin>(tick.origin));
  if (writer.Write(message) != WriteStatus::kOk) ++impl_->counts.write_failures;
}

#define SINEW_INSTANTIATE(Type)                                                           \
  template class TickInput<msg::Type>;                                                    \
  template TickInput<msg::Type>& TickLoop::AddInput(const Topic<msg::Type>&, InputRules); \
  template void TickLoop::Publish(Writer<msg::Type>&, msg::Type, const Tick&);
SINEW_FOR_EACH_HEADED_MESSAGE(SINEW_INSTANTIATE)
#undef SINEW_INSTANTIATE

}  // namespace sinew::node
