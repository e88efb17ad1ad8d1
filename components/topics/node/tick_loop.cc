#include "components/topics/node/tick_loop.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <vector>

#include "components/base/types/clock/clock.h"
#include "components/base/types/command_rule.h"
#include "components/base/types/message_header.h"
#include "components/base/types/robot_state.h"
#include "components/topics/node/all_messages.h"
#include "components/topics/node/command_gate.h"
#include "components/topics/node/cut_off.h"
#include "components/topics/node/input_queue.h"
#include "components/topics/node/node_impl.h"
#include "components/topics/node/other_owner.h"
#include "components/topics/node/realtime.h"
#include "components/topics/node/replay_gate.h"
#include "components/topics/node/tick_period.h"

namespace sinew::node {

using Clock = std::chrono::steady_clock;
using internal::InputQueue;

namespace internal {

namespace {

// A number without a name, of a message that is not decoded yet: never live.
msg::Origin OriginOf(const HeadOfMessage& head) {
  const bool named = head.origin < CountOf(msg::Origin{});
  return named ? static_cast<msg::Origin>(head.origin) : msg::Origin::kReplay;
}

}  // namespace

// An input without its type: a DDS reader and the samples that it gave, by tick.
class InputBase {
 public:
  InputBase(std::unique_ptr<ReaderImpl> reader, InputRules rules)
      : queue(rules, reader->queue_limit), reader_(std::move(reader)) {}
  virtual ~InputBase() = default;

  // Moves what DDS has received into the queue: of a trigger what `admits` does.
  template <class Admits>
  void Collect(const Admits& admits) {
    while (auto sample = reader_->TakeNext()) {
      HeadOfMessage head;
      if (!PeekHead(sample->bytes.data(), sample->bytes.size(), &head)) {
        reader_->CountMalformed();
        continue;
      }
      if (!admits(head, sample->writer)) continue;
      newest_came_ns_ = sample->reception_stamp_ns;
      queue.Push(head, std::move(sample->bytes), sample->writer);
    }
  }
  // Only what belongs to the session, and of a commanding topic what the rule admits.
  void CollectOf(const types::RunningSession& running) {
    Collect([&](const HeadOfMessage& head, const WriterId& writer) {
      if (!commands_) return head.session_id == running.session_id;
      const types::MessageHeader header{
          .session_id = head.session_id, .tick = head.tick, .origin = OriginOf(head)};
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
    if (queue.accepted() && origin() == msg::Origin::kReplay) queue.Reset();
  }
  // The value counts as live.
  bool replay_permitted() const {
    return replay && replay->holds() && queue.accepted() && origin() == msg::Origin::kReplay;
  }
  // The source that wakes a thread that waits for this input (wake_signal.h).
  const void* source() const { return reader_.get(); }
  // Nothing for the cycle of this tick was collected.
  bool Missing(std::uint64_t tick) const { return queue.rules().required && !queue.Reached(tick); }
  bool HasMore() const { return !reader_->empty(); }  // to collect
  // The time since the newest sample that was taken had come.
  std::chrono::nanoseconds Age() const {
    return std::chrono::nanoseconds(types::EpochNow_ns() - newest_came_ns_);
  }

  const std::string& topic() const { return reader_->topic.name; }
  std::uint64_t dropped() const { return reader_->dropped() + queue.dropped(); }
  // False: malformed, and the last value stays.
  virtual bool DecodeValue(const Bytes& bytes) = 0;
  virtual msg::Origin origin() const = 0;  // of the value
  // Describes the cycle by the message of a trigger.
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
  std::unique_ptr<ReaderImpl> reader_;
  std::int64_t newest_came_ns_ = 0;  // epoch
  CommandGate gate_{topic()};
  const bool commands_ = std::find(kCommandingTopics.begin(), kCommandingTopics.end(), topic()) !=
                         kCommandingTopics.end();
};

}  // namespace internal

using internal::InputBase;

namespace {

// A cycle as long as that controls nothing: a message that declares a longer one is refused.
constexpr double kLongestPeriod_s = 10.0;

// A period that a message claims is no reason to wait for more than a second, or to overflow.
std::chrono::nanoseconds BoundedPeriod(double nominal_period_s) {
  const double period_s = nominal_period_s > 0.0 ? std::min(nominal_period_s, 1.0) : 0.0;
  return std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 * period_s));
}

// Silence of an owner after which readers hear the next one, in whole periods: a tick is any number
// that a message claims. Without a period: 0.
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
      if (!(next.period_s > 0.0 && next.period_s <= kLongestPeriod_s)) return false;
    }
    std::swap(message, next);
    return true;
  }
  bool robot_may_move() const override {
    if constexpr (std::is_same_v<Message, msg::JointState>) {
      return types::MayMove(message.robot_state);
    }
    return false;
  }
  msg::Origin origin() const override { return message.header.origin; }
  void Describe(Tick* tick) const override {
    tick->stamp_ns = message.header.stamp_ns;
    tick->origin = origin();
    if constexpr (std::is_same_v<Message, msg::JointState>) {
      tick->nominal_period_s = message.period_s;
      tick->last = message.last_tick;
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

namespace {

// The field of an output that names the tick of an input (idl/header.idl), and the input's topic.
struct TickField {
  std::string_view field, topic;
};
constexpr std::array<TickField, 9> kTickFields = {{{"state_tick", kJointState.name},
                                                   {"actuator_tick", kActuatorState.name},
                                                   {"reference_tick", kReference.name},
                                                   {"regime_tick", kRegime.name},
                                                   {"prediction_tick", kTorquePrediction.name},
                                                   {"readout_tick", kReadout.name},
                                                   {"motion_tick", kMotionRequest.name},
                                                   {"reservoir_tick", kReservoirState.name},
                                                   {"command_tick", kJointCommand.name}}};
constexpr std::size_t kMostEvents = 16;  // bound of event_ids

}  // namespace

struct TickLoop::Impl {
  Node& node;
  StopFlag& stop;
  const TickLoopOptions options;
  const bool lockstep;
  const bool apart;            // no clock counts: composition.h
  const bool waits;            // for inputs: a composed participant hears nothing while it waits
  const double cut_off_share;  // of the nominal period
  internal::Status& status;
  std::vector<std::shared_ptr<InputBase>> inputs;  // the first one is the trigger
  std::vector<std::shared_ptr<void>> handles;      // TickInput objects given out
  Node::Counts counts;
  TickPeriod period;
  std::uint64_t session_id = 0;
  types::RunningSession running;  // as the trigger's last message says
  std::optional<std::uint64_t> last_tick;
  // Ticks of the last two cycles in the session, which not every accepted trigger is.
  std::optional<std::uint64_t> last_cycle_tick{}, previous_cycle{};
  bool ended = false;
  std::vector<std::uint64_t> events{};   // that count in this cycle
  std::optional<HeadOfMessage> begun{};  // the trigger of the next cycle, accepted
  std::vector<const void*> awaited{};    // scratch: the sources of a wait
  Clock::time_point next_cut_off{};      // when the next cycle goes on without late inputs
  Clock::time_point last_cycle{};        // of last_tick
  std::int64_t last_stamp_ns = 0;        // of last_tick's trigger
  Clock::time_point quiet_until{};
  // Until then it joins below others, and they exchange what they are: work for later (realtime.h).
  const Clock::time_point settled = Clock::now() + internal::kSettleTime;

  bool Settled() const {
    if (apart) return node.options().composition->settled();
    return lockstep || Clock::now() >= settled;
  }

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

  // A session is its writer's for as long as that is heard. Another state provider that discovery
  // found late is not followed: one of the two ends (provider/participant/other_provider.h).
  bool IsOfAnotherProvider(const HeadOfMessage& head, const WriterId& writer) const {
    if (lockstep || apart || !last_tick || head.session_id == session_id) return false;
    return writer != inputs.front()->queue.writer() &&
           Clock::now() - last_cycle < internal::kSettleTime;
  }

  // The head of the next trigger sample, when there is one; it is the oldest of the queue.
  std::optional<HeadOfMessage> NextTrigger() {
    InputBase& trigger = *inputs.front();
    trigger.Collect([this](const HeadOfMessage& head, const WriterId& writer) {
      return !IsOfAnotherProvider(head, writer);
    });
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
      AwaitTrigger();
      status.Beat();
    }
    return std::exchange(begun, std::nullopt);
  }

  // One wake-up a cycle: with the trigger the inputs of the next tick are awaited, in real time
  // until the cut-off after the trigger is expected. Without one by then, for the trigger alone.
  void AwaitTrigger() {
    using std::chrono::microseconds;
    microseconds timeout = std::chrono::milliseconds(50);
    awaited.assign(1, inputs.front()->source());
    const auto left = std::chrono::duration_cast<microseconds>(next_cut_off - Clock::now());
    if (last_tick && (lockstep || left.count() > 0)) {
      if (!lockstep) timeout = std::min(timeout, left);
      for (std::size_t i = 1; i < inputs.size(); ++i) {
        if (inputs[i]->Missing(*last_tick + 1) && !inputs[i]->HasMore()) {
          awaited.push_back(inputs[i]->source());
        }
      }
    }
    node.impl_->signal.Wait(timeout, awaited);
  }

  Tick Begin(const HeadOfMessage& head) {
    if (!last_tick || head.session_id != session_id) {
      session_id = head.session_id;
      last_tick.reset();
      last_cycle_tick.reset();
      for (std::size_t i = 1; i < inputs.size(); ++i) inputs[i]->queue.Reset();
    }
    Tick tick;
    tick.session_id = head.session_id;
    tick.tick = head.tick;
    tick.nominal_period_s = options.nominal_period_s;
    inputs.front()->Describe(&tick);
    return tick;
  }

  // Until all samples of the tick are here, or in real time the deadline. False: stop was
  // requested.
  bool AwaitInputs(std::uint64_t tick, Clock::time_point deadline) {
    using std::chrono::microseconds;
    while (true) {
      awaited.clear();
      bool more = false;  // came after it was looked for: the cycle must not begin without it
      for (std::size_t i = 1; i < inputs.size(); ++i) {
        inputs[i]->CollectOf(running);
        if (!inputs[i]->Missing(tick)) continue;
        if (inputs[i]->HasMore()) {
          more = true;
        } else {
          awaited.push_back(inputs[i]->source());
        }
      }
      if (awaited.empty() && !more) return true;
      if (stop.requested()) return false;
      const auto left = std::chrono::duration_cast<microseconds>(deadline - Clock::now());
      if (!waits || (!lockstep && left.count() <= 0)) return true;
      if (more) continue;
      node.impl_->signal.Wait(lockstep ? microseconds(std::chrono::milliseconds(50)) : left,
                              awaited);
      status.Beat();
    }
  }

  // The cut-off of the cycle whose trigger was taken: counted from its arrival, maybe a while ago.
  Clock::time_point GiveUpAt(double nominal_period_s) {
    const std::chrono::nanoseconds cycle = BoundedPeriod(nominal_period_s);
    const auto age = std::clamp(inputs.front()->Age(), std::chrono::nanoseconds(0), cycle);
    const Clock::time_point give_up = Clock::now() - age + CutOff(nominal_period_s);
    next_cut_off = give_up + cycle;
    return give_up;
  }

  // The owner of a topic that has been silent for longer than its readers wait was replaced: by
  // ticks, or by the clock, since what waited in the sockets of a process that was stopped seems to
  // come in time. A trigger that was itself late is not the participant's silence.
  bool WasSilent(const Tick& tick) const {
    const std::chrono::nanoseconds nominal = BoundedPeriod(tick.nominal_period_s);
    if (lockstep || !last_tick || nominal.count() == 0) return false;
    if (node.options().composition != nullptr) return false;  // silent with its provider
    const std::uint64_t ticks = tick.tick - *last_tick;
    if (ticks > PeriodsOfSilence(tick.nominal_period_s)) return true;
    const std::chrono::nanoseconds triggers(
        std::max<std::int64_t>(tick.stamp_ns - last_stamp_ns, 0));
    const auto passed =
        std::max<std::chrono::nanoseconds>(triggers, static_cast<std::int64_t>(ticks) * nominal);
    return Clock::now() - last_cycle - passed > internal::Deadline(nominal);
  }

  // A participant that was silent and has been replaced is quiet for as long as the others may need
  // to learn that it is below, as one that joins, and takes no trigger from before: what it would
  // say first is of before it was stopped, and a deadline is too short since discovery is below the
  // cycles. It is the owner again where those were silent as well (a core that stood still) and
  // went below it, or by a handover.
  bool MustBeQuiet(const Tick& tick) {
    const auto now = Clock::now();
    if (WasSilent(tick) && node.impl_->ownership.StepBelow(now - last_cycle)) {
      quiet_until = now + internal::kSettleTime;
    }
    if (last_tick && tick.tick > *last_tick + 1) counts.missed_ticks += tick.tick - *last_tick - 1;
    last_tick = tick.tick;
    last_stamp_ns = tick.stamp_ns;
    last_cycle = now;
    if (now >= quiet_until || tick.last) return false;
    if (node.impl_->ownership.Leads()) {
      quiet_until = now;
      return false;
    }
    ++counts.missed_ticks;
    return true;
  }

  bool TooLate(const Tick& tick) const {
    const std::chrono::nanoseconds nominal = BoundedPeriod(tick.nominal_period_s);
    return !lockstep && !apart && nominal.count() > 0 &&
           Clock::now() - last_cycle > internal::Deadline(nominal);
  }

  // Tick of the input of this topic, kNoTick where nothing was used; where the loop reads no
  // joint_state, what the output says of it.
  std::uint64_t InputTick(std::string_view topic, std::uint64_t said) const {
    for (const std::shared_ptr<InputBase>& input : inputs) {
      if (input->topic() == topic) {
        return input->queue.accepted() ? input->queue.accepted_tick() : kNoTick;
      }
    }
    return topic == kJointState.name ? said : kNoTick;
  }

  // Fills the fields by which an output names its inputs, where it has them.
  struct Naming {
    const Impl& loop;
    const bool joining;

    void operator()(std::string_view name, std::uint64_t& tick, std::size_t) const {
      if (name == "previous_tick") tick = loop.previous_cycle.value_or(kNoTick);
      for (const TickField& known : kTickFields) {
        if (known.field == name) tick = loop.InputTick(known.topic, tick);
      }
    }
    void operator()(std::string_view name, std::vector<std::uint64_t>& ids, std::size_t) const {
      if (name == "event_ids") ids = loop.events;
    }
    void operator()(std::string_view name, bool& flag, std::size_t) const {
      if (name == "joining") flag = joining;
    }
    template <class T>
    void operator()(std::string_view, T&, std::size_t) const {}
  };

  std::chrono::nanoseconds CutOff(double nominal_period_s) const {
    return std::chrono::nanoseconds(static_cast<std::int64_t>(
        cut_off_share * static_cast<double>(BoundedPeriod(nominal_period_s).count())));
  }
};

TickLoop::TickLoop(Node& node, StopFlag& stop, TickLoopOptions options)
    : impl_(new Impl{.node = node,
                     .stop = stop,
                     .options = options,
                     .lockstep = node.options().mode == TimeMode::kLockstep,
                     .apart = node.impl_->apart(),
                     .waits = node.options().composition == nullptr,
                     .cut_off_share = node.options().composition != nullptr ? 0.0
                                      : options.cut_off_share > 0.0
                                          ? options.cut_off_share
                                          : CutOffOf(RoleOf(node.options())).share,
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

void TickLoop::Used(std::uint64_t event_id) {
  std::vector<std::uint64_t>& events = impl_->events;
  const bool known = std::find(events.begin(), events.end(), event_id) != events.end();
  if (!known && events.size() < kMostEvents) events.push_back(event_id);
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
  std::optional<HeadOfMessage> head;
  Tick tick;
  do {
    head = self.WaitForTrigger();
    if (!head) return std::nullopt;
    tick = self.Begin(*head);
    tick.settled = self.Settled();
    if (tick.settled) BeginRealtime();
  } while (self.MustBeQuiet(tick));
  self.running = {tick.session_id, trigger.origin()};
  for (const std::shared_ptr<InputBase>& input : self.inputs) {
    if (input->replay) input->replay->Cycle(self.running, trigger.robot_may_move());
  }
  if (!self.AwaitInputs(head->tick, self.GiveUpAt(tick.nominal_period_s))) return std::nullopt;
  self.previous_cycle = std::exchange(self.last_cycle_tick, tick.tick);
  bool replayed = false;
  for (std::size_t i = 1; i < self.inputs.size(); ++i) {
    InputBase& input = *self.inputs[i];
    input.queue.Accept(head->tick, self.lockstep, input.decode);
    const InputRules& rules = input.queue.rules();
    const bool expected = head->tick >= static_cast<std::uint64_t>(rules.delay_ticks);
    tick.any_stale |= rules.required && expected && !input.queue.fresh();
    input.ForgetReplay(self.running);
    const bool permitted = self.running.origin == types::Origin::kLive && input.replay_permitted();
    tick.replay_permitted |= permitted;
    replayed |= input.queue.accepted() && input.origin() == msg::Origin::kReplay && !permitted;
  }
  const double period_s = self.period.Next(tick.session_id, tick.tick, tick.stamp_ns,
                                           tick.origin == msg::Origin::kSim, tick.nominal_period_s);
  tick.period_s = self.lockstep ? tick.nominal_period_s : period_s;
  // A command that is computed from a recording is no live one, whatever triggered it.
  if (replayed) tick.origin = msg::Origin::kReplay;

  if (tick.nominal_period_s > 0.0) self.node.SetPeriod(BoundedPeriod(tick.nominal_period_s));
  self.node.impl_->ownership.SetCycle(tick.session_id, trigger.origin(), tick.stamp_ns);
  if (tick.any_stale) ++self.counts.stale_inputs;
  ++self.counts.cycles;
  self.ended = tick.last;
  self.events.clear();
  self.node.SetCycle(tick.session_id, tick.tick, tick.stamp_ns, tick.origin);
  if (self.counts.cycles == 1) self.node.SetState(Node::State::kActive);
  if (!self.lockstep || (self.counts.cycles & 63u) == 0) self.node.SetCounts(self.counts);
  return tick;
}

template <class Message>
requires kBeginsWithHeader<Message>
void TickLoop::Publish(Writer<Message>& writer, Message message, const Tick& tick) {
  if (impl_->TooLate(tick)) {
    ++impl_->counts.missed_ticks;
    return;
  }
  message.header = {tick.session_id, tick.tick, tick.stamp_ns, tick.origin};
  Message::Fields(message, Impl::Naming{*impl_, !tick.settled});
  if (writer.Write(message) != WriteStatus::kOk) ++impl_->counts.write_failures;
}

#define SINEW_INSTANTIATE(Type)                                                           \
  template class TickInput<msg::Type>;                                                    \
  template TickInput<msg::Type>& TickLoop::AddInput(const Topic<msg::Type>&, InputRules); \
  template void TickLoop::Publish(Writer<msg::Type>&, msg::Type, const Tick&);
SINEW_FOR_EACH_HEADED_MESSAGE(SINEW_INSTANTIATE)
#undef SINEW_INSTANTIATE

}  // namespace sinew::node
