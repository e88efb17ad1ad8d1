#include "components/node/tick_loop.h"

#include "components/node/all_messages.h"
#include "components/node/node_impl.h"

namespace sinew::node {

using Clock = std::chrono::steady_clock;

namespace internal {

// An input without its type: a queue of samples with their ticks.
class InputBase {
 public:
  InputBase(std::shared_ptr<internal::ReaderImpl> reader, InputRules rules)
      : reader_(std::move(reader)), rules_(rules) {}
  virtual ~InputBase() = default;

  const InputRules& rules() const { return rules_; }
  const std::string& topic() const { return reader_->topic.name; }

  // Moves what DDS has received into the queue; samples of other sessions are dropped.
  void Collect(std::uint64_t session_id) {
    while (auto sample = reader_->TakeNext()) {
      HeadOfMessage head;
      if (!PeekHead(sample->bytes.data(), sample->bytes.size(), &head)) continue;
      if (session_id != 0 && head.session_id != session_id) continue;
      queue_.push_back({head, std::move(sample->bytes)});
    }
  }

  bool Reached(std::uint64_t tick) const {
    const auto delay = static_cast<std::uint64_t>(rules_.delay_ticks);
    if (tick < delay) return true;  // there is none before the delay
    const std::uint64_t wanted = tick - delay;
    if (accepted_ && accepted_tick_ >= wanted) return true;
    return !queue_.empty() && queue_.back().head.tick >= wanted;
  }

  // Takes the sample of tick - delay: in lockstep that very one, in real time the newest.
  void Accept(std::uint64_t tick, bool lockstep) {
    const auto delay = static_cast<std::uint64_t>(rules_.delay_ticks);
    fresh = false;
    if (tick < delay) return;
    const std::uint64_t wanted = tick - delay;
    while (!queue_.empty() &&
           (!lockstep || queue_.front().head.tick <= wanted || !rules_.required)) {
      if (DecodeValue(queue_.front().bytes)) {
        accepted_ = true;
        accepted_tick_ = queue_.front().head.tick;
      }
      queue_.pop_front();
    }
    fresh = accepted_ && accepted_tick_ >= wanted;
  }

  void Reset() {
    queue_.clear();
    accepted_ = false;
    fresh = false;
  }

  // Sleeps until a sample of this input arrives or the timeout is over.
  void Wait(std::chrono::microseconds timeout) { reader_->WaitForSample(timeout); }

  struct Queued {
    HeadOfMessage head;
    Bytes bytes;
  };
  std::deque<Queued>& queue() { return queue_; }
  bool accepted() const { return accepted_; }
  std::uint64_t accepted_tick() const { return accepted_tick_; }

  bool fresh = false;

 protected:
  virtual bool DecodeValue(const Bytes& bytes) = 0;

 private:
  std::shared_ptr<internal::ReaderImpl> reader_;
  InputRules rules_;
  std::deque<Queued> queue_;
  bool accepted_ = false;
  std::uint64_t accepted_tick_ = 0;
};

}  // namespace internal

using internal::InputBase;

template <class Message>
struct TickInput<Message>::State final : public InputBase {
  using InputBase::InputBase;
  Message message;

 protected:
  bool DecodeValue(const Bytes& bytes) override { return Decode(bytes, &message); }
};

template <class Message>
bool TickInput<Message>::has_value() const {
  return state_->accepted();
}
template <class Message>
const Message& TickInput<Message>::value() const {
  return state_->message;
}
template <class Message>
bool TickInput<Message>::fresh() const {
  return state_->fresh;
}
template <class Message>
std::uint64_t TickInput<Message>::tick() const {
  return state_->accepted_tick();
}

struct TickLoop::Impl {
  Node& node;
  StopFlag& stop;
  std::chrono::microseconds cut_off;
  std::vector<std::shared_ptr<InputBase>> inputs;  // the first one is the trigger
  std::vector<std::shared_ptr<void>> handles;      // TickInput objects given out
  Node::Counts counts;
  std::uint64_t session_id = 0;
  std::optional<std::uint64_t> last_tick;
  bool ended = false;

  // The head of the next trigger sample, when there is one.
  std::optional<HeadOfMessage> NextTrigger(bool lockstep) {
    InputBase& trigger = *inputs.front();
    trigger.Collect(0);
    auto& queue = trigger.queue();
    if (!lockstep) {
      while (queue.size() > 1) queue.pop_front();
    }
    while (!queue.empty()) {
      const HeadOfMessage head = queue.front().head;
      const bool seen = last_tick && head.session_id == session_id && head.tick <= *last_tick;
      if (!seen) return head;
      queue.pop_front();
    }
    return std::nullopt;
  }

  void StartSession(const HeadOfMessage& head) {
    session_id = head.session_id;
    last_tick.reset();
    for (std::size_t i = 1; i < inputs.size(); ++i) inputs[i]->Reset();
  }
};

TickLoop::TickLoop(Node& node, StopFlag& stop, std::chrono::microseconds cut_off)
    : impl_(new Impl{node, stop, cut_off, {}, {}, {}, 0, std::nullopt, false}) {}

TickLoop::~TickLoop() = default;

template <class Message>
TickInput<Message>& TickLoop::AddInput(const Topic<Message>& topic, InputRules rules) {
  auto reader =
      std::make_shared<internal::ReaderImpl>(impl_->node.impl_, *FindTopic(topic.name), 0, nullptr);
  auto input = std::make_shared<TickInput<Message>>();
  input->state_ = std::make_shared<typename TickInput<Message>::State>(std::move(reader), rules);
  impl_->inputs.push_back(input->state_);
  impl_->handles.push_back(input);
  return *input;
}

std::optional<Tick> TickLoop::Next() {
  using std::chrono::milliseconds;
  Impl& self = *impl_;
  const bool lockstep = self.node.options().mode == TimeMode::kLockstep;
  if (self.ended) {
    self.node.SetState(Node::State::kStopped, "session ended");
    return std::nullopt;
  }
  if (!self.last_tick && self.counts.cycles == 0) {
    self.node.SetState(Node::State::kConfigured, "waiting for " + self.inputs.front()->topic());
  }
  std::optional<HeadOfMessage> head;
  while (!(head = self.NextTrigger(lockstep))) {
    if (self.stop.requested()) return std::nullopt;
    self.inputs.front()->Wait(milliseconds(50));
    self.node.impl_->status.PublishIfDue();
  }
  if (!self.last_tick || head->session_id != self.session_id) self.StartSession(*head);
  const auto deadline = Clock::now() + self.cut_off;
  bool any_stale = false;
  for (std::size_t i = 1; i < self.inputs.size(); ++i) {
    InputBase& input = *self.inputs[i];
    input.Collect(self.session_id);
    while (input.rules().required && !input.Reached(head->tick)) {
      if (self.stop.requested()) return std::nullopt;
      const auto left =
          std::chrono::duration_cast<std::chrono::microseconds>(deadline - Clock::now());
      if (!lockstep && left.count() <= 0) break;
      input.Wait(lockstep ? std::chrono::microseconds(milliseconds(50)) : left);
      self.node.impl_->status.PublishIfDue();
      input.Collect(self.session_id);
    }
    input.Accept(head->tick, lockstep);
    if (input.rules().required && !input.fresh &&
        head->tick >= static_cast<std::uint64_t>(input.rules().delay_ticks)) {
      any_stale = true;
    }
  }
  // The trigger itself: exactly the sample whose head was looked at.
  InputBase& trigger = *self.inputs.front();
  auto& queue = trigger.queue();
  std::deque<InputBase::Queued> later;
  while (queue.size() > 1) {
    later.push_front(std::move(queue.back()));
    queue.pop_back();
  }
  trigger.Accept(head->tick, lockstep);
  queue = std::move(later);

  Tick tick;
  tick.session_id = head->session_id;
  tick.tick = head->tick;
  tick.any_stale = any_stale;
  if (auto* state = dynamic_cast<TickInput<msg::JointState>::State*>(&trigger)) {
    const msg::JointState& message = state->message;
    tick.stamp_ns = message.header().stamp_ns();
    tick.origin = static_cast<int>(message.header().origin());
    tick.period_s = message.period_s();
    tick.last = message.last_tick();
  }
  if (self.last_tick && tick.tick > *self.last_tick + 1) {
    self.counts.missed_ticks += tick.tick - *self.last_tick - 1;
  }
  if (any_stale) ++self.counts.stale_inputs;
  ++self.counts.cycles;
  self.last_tick = tick.tick;
  self.ended = tick.last;
  self.node.SetCycle(tick.session_id, tick.tick, tick.stamp_ns, tick.origin);
  if (self.counts.cycles == 1) self.node.SetState(Node::State::kActive);
  if (!lockstep || (self.counts.cycles & 63u) == 0) self.node.SetCounts(self.counts);
  return tick;
}

template <class Message>
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
SINEW_FOR_EACH_MESSAGE(SINEW_INSTANTIATE)
#undef SINEW_INSTANTIATE

}  // namespace sinew::node
