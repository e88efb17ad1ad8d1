// The loop of a participant: woken by the state provider's tick, once a tick.
//
//   node::TickLoop loop(node, stop);
//   auto& state = loop.AddInput(node::kJointState);            // the first input is the trigger
//   auto& regime = loop.AddInput(node::kRegime);
//   auto& readout = loop.AddInput(node::kReadout, {.delay_ticks = 1});
//   auto output = node.MakeWriter(node::kTorquePrediction);
//   while (const auto tick = loop.Next()) {
//     msg::TorquePrediction message = ...;
//     loop.Publish(output, std::move(message), *tick);  // fills header and input ticks, counts
//     failures
//   }
//
// Real time: the trigger's newest sample starts the cycle; other inputs of that tick are awaited
// until the cut-off (cut_off.h) and are stale afterwards. Lockstep: ticks come one by one, and a
// cycle starts when every input has its sample of tick - delay (ticks before the delay have none:
// value() is then empty).
//
// Of a commanding topic (idl/README.md) an input takes what the rule of components/base/types/
// command_rule.h admits; the state provider's origin and session are those of the trigger. What is
// refused is counted and logged, and is as if it had never come. Live hardware takes the reference
// of a recording with an operator's permission only (replay_permission.h).
//
// Trigger and inputs may be any message that begins with its header; another one does not compile.
// Only joint_state carries a period and the end of the session: a loop with another trigger needs
// TickLoopOptions::nominal_period_s, and runs until stop is requested.
//
// Threads: one thread, the node's. Next() allocates.
#pragma once

#include <sinew_idl/header.h>

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>

#include "components/topics/node/node.h"

namespace sinew::node {

// Value of an output's *_tick when there was no input (idl/header.idl).
inline constexpr std::uint64_t kNoTick = std::numeric_limits<std::uint64_t>::max();

struct Tick {
  std::uint64_t session_id = 0;
  std::uint64_t tick = 0;
  std::int64_t stamp_ns = 0;  // of the trigger
  msg::Origin origin{};       // of the trigger; kReplay when any input is from a recording
  double period_s = 0.0;      // since the last cycle: tick_period.h; in lockstep nominal_period_s
  double nominal_period_s = 0.0;
  bool last = false;  // the session's last tick: Next() returns nothing after it
  bool any_stale = false;
  bool settled = false;  // who else writes the participant's topics is known by now (ownership.h)
  bool replay_permitted = false;  // the reference is a recording's that may move live hardware
};

struct InputRules {
  int delay_ticks = 0;
  bool required = true;  // false: never awaited; the newest sample is used if there is one
};

struct TickLoopOptions {
  double cut_off_share = 0.0;     // real time, of the nominal period; 0: by kind, cut_off.h
  double nominal_period_s = 0.0;  // of a trigger other than joint_state, which carries its own
};

template <class Message>
class TickInput {
 public:
  bool has_value() const;        // false until the first sample
  const Message& value() const;  // the sample of this cycle, or the last one when stale
  bool fresh() const;            // belongs to this cycle (tick - delay)
  // This cycle's sample is another writer's than the one before: its topic has a new owner.
  bool writer_changed() const;
  std::uint64_t tick() const;  // of value()
  // Samples dropped unread because a queue was full (limits: see Reader), or in real time because
  // newer ones were there before the loop came to them.
  std::uint64_t dropped() const;
  std::uint64_t malformed() const;  // as Reader::malformed
  std::uint64_t refused() const;    // of a commanding topic, by the rule of command_rule.h

 private:
  friend class TickLoop;
  struct State;
  std::shared_ptr<State> state_;
};

class TickLoop {
 public:
  TickLoop(Node& node, StopFlag& stop, TickLoopOptions options = {});
  ~TickLoop();

  // Before the first Next(). Throws std::invalid_argument when the first input carries no period
  // and the options have none, or when it is to be delayed.
  template <class Message>
  requires kBeginsWithHeader<Message> TickInput<Message>
  &AddInput(const Topic<Message>& topic, InputRules rules = {});

  // A cycle has begun: Next() returns at once. For composed nodes (composition.h), which wait for
  // neither trigger nor inputs: what has not come is stale.
  bool Ready();
  // Blocks for the next cycle. Nothing: stop was requested or the session ended.
  std::optional<Tick> Next();

  // An event counts in this cycle: outputs that carry event_ids name it. EventId, codec.h.
  void Used(std::uint64_t event_id);

  // Fills the header and what header.idl says of outputs. In real time nothing
  // is published that comes later than readers wait for an owner (ownership.h): a process that was
  // stopped in the middle of a cycle does not end it.
  template <class Message>
  requires kBeginsWithHeader<Message>
  void Publish(Writer<Message>& writer, Message message, const Tick& tick);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sinew::node
