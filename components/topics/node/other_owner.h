// Samples of another participant on an EXCLUSIVE topic that this one writes too, while the other is
// heard: a standby follows them, one by one, so that its state is the owner's.
//
// Real time only: in lockstep no topic has owners, and there is never anything. Thread: the node's.
#pragma once

#include <sinew_idl/header.h>

#include <cstdint>
#include <optional>

#include "components/topics/node/tick_loop.h"

namespace sinew::node {

// True while a sample of owner_tick says that its writer still is the owner in this tick: for as
// long as readers bear its silence (ownership.h).
bool StillOwner(std::uint64_t owner_tick, const Tick& tick);

template <class Message>
class OtherOwner {
 public:
  // Throws DdsError.
  OtherOwner(Node& node, const Topic<Message>& topic) : node_(node) {
    if (node.options().mode == TimeMode::kRealtime) reader_.emplace(node.MakeReader(topic));
  }

  // The oldest one that was not taken. Own samples are left out, those of other sessions, and those
  // that do not say any more whose the topic is: a writer that was stopped sends what it was about
  // to send when it goes on, and nobody must go on from there.
  std::optional<Message> TakeNext(const Tick& tick) {
    while (reader_) {
      auto message = reader_->TakeNext();
      if (!message) break;
      if (node_.Owns(reader_->writer())) {
        heard_tick_.reset();
        continue;
      }
      const bool same_session = message->header.session_id == tick.session_id;
      if (!same_session || !StillOwner(message->header.tick, tick)) continue;
      session_id_ = tick.session_id;
      heard_tick_ = message->header.tick;
      replayed_ = message->header.origin == msg::Origin::kReplay;
      return message;
    }
    return std::nullopt;
  }

  // Another one is the owner, as far as was taken; or was when this one was stopped: what it has
  // said since may still wait in the sockets. component_status says it from here on.
  bool StandsBy(const Tick& tick) {
    const bool same_session = last_ && last_->session_id == tick.session_id;
    if (!same_session) {
      resumed_tick_.reset();
    } else if (stood_by_ && !StillOwner(last_->tick, tick)) {
      resumed_tick_ = tick.tick;
    }
    stood_by_ = Heard(tick) || (resumed_tick_ && StillOwner(*resumed_tick_, tick));
    last_ = tick;
    node_.SetStandby(stood_by_);
    return stood_by_;
  }

  // Marks what is computed from a replayed owner as that.
  void MarkOrigin(Tick* tick) const {
    if (Heard(*tick) && replayed_) tick->origin = msg::Origin::kReplay;
  }

  // Takes all and reports, for a participant that has no state to follow with.
  void Watch(const Tick& tick) {
    while (TakeNext(tick)) {
    }
    (void)StandsBy(tick);
  }

 private:
  bool Heard(const Tick& tick) const {
    return heard_tick_ && session_id_ == tick.session_id && StillOwner(*heard_tick_, tick);
  }

  Node& node_;
  std::optional<Reader<Message>> reader_;
  std::uint64_t session_id_ = 0;
  std::optional<std::uint64_t> heard_tick_;
  bool replayed_ = false;
  // Tick and answer of the last StandsBy, and the first tick after a silence of this one.
  std::optional<Tick> last_;
  bool stood_by_ = false;
  std::optional<std::uint64_t> resumed_tick_;
};

}  // namespace sinew::node
