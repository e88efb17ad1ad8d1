// The samples of one input of a TickLoop, by tick: which one belongs to a cycle.
//
// Pure and of one thread. Decoding is the caller's: `decode` gets the bytes and returns false when
// they are no such message; such a sample is skipped.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>

#include "components/topics/node/codec.h"
#include "components/topics/node/tick_loop.h"

namespace sinew::node::internal {

class InputQueue {
 public:
  using Decode = std::function<bool(const Bytes&)>;

  InputQueue(InputRules rules, std::size_t limit) : rules_(rules), limit_(limit) {}

  // A full queue drops its oldest sample.
  void Push(const HeadOfMessage& head, Bytes bytes, const WriterId& writer = {});
  // True when nothing better than what is here will come for this tick: the sample of tick - delay
  // or a later one is here or accepted, or the tick is before the delay.
  bool Reached(std::uint64_t tick) const;
  // Accepts the sample of tick - delay: in lockstep that very one, in real time (or when it is not
  // required) the newest.
  void Accept(std::uint64_t tick, bool lockstep, const Decode& decode);
  // Accepts the oldest sample of a trigger. False: it was malformed, and is dropped.
  bool AcceptFront(const Decode& decode);
  void DropFront() { samples_.pop_front(); }
  void DropAllButNewest();
  // A new session: forgets what was accepted, and all samples.
  void Reset();

  std::optional<HeadOfMessage> front() const;  // of the oldest sample
  bool accepted() const { return accepted_tick_.has_value(); }
  std::uint64_t accepted_tick() const { return accepted_tick_.value_or(0); }
  bool fresh() const { return fresh_; }  // what was accepted belongs to the last cycle
  // The last cycle's sample is another writer's than the one accepted before it.
  bool writer_changed() const { return writer_changed_; }
  const WriterId& writer() const { return writer_; }  // of what was accepted last
  const InputRules& rules() const { return rules_; }
  std::uint64_t dropped() const { return dropped_; }  // by Push and DropAllButNewest

 private:
  struct Entry {
    HeadOfMessage head;
    Bytes bytes;
    WriterId writer;
  };
  bool AcceptEntry(const Decode& decode);

  const InputRules rules_;
  const std::size_t limit_;
  std::deque<Entry> samples_;
  std::optional<std::uint64_t> accepted_tick_;
  bool fresh_ = false;
  WriterId writer_{};  // of what was accepted
  bool writer_changed_ = false;
  std::uint64_t dropped_ = 0;
};

}  // namespace sinew::node::internal
