#include "components/topics/node/input_queue.h"

#include <utility>

namespace sinew::node::internal {

void InputQueue::Push(const HeadOfMessage& head, Bytes bytes, const WriterId& writer) {
  if (samples_.size() >= limit_) {
    samples_.pop_front();
    ++dropped_;
  }
  samples_.push_back({head, std::move(bytes), writer});
}

bool InputQueue::Reached(std::uint64_t tick) const {
  const auto delay = static_cast<std::uint64_t>(rules_.delay_ticks);
  if (tick < delay) return true;
  const std::uint64_t wanted = tick - delay;
  if (accepted_tick_ && *accepted_tick_ >= wanted) return true;
  return !samples_.empty() && samples_.back().head.tick >= wanted;
}

void InputQueue::Accept(std::uint64_t tick, bool lockstep, const Decode& decode) {
  const auto delay = static_cast<std::uint64_t>(rules_.delay_ticks);
  fresh_ = writer_changed_ = false;
  if (tick < delay) return;
  const std::uint64_t wanted = tick - delay;
  const bool only_wanted = lockstep && rules_.required;
  while (!samples_.empty() && (!only_wanted || samples_.front().head.tick <= wanted)) {
    AcceptEntry(decode);
  }
  fresh_ = accepted_tick_ && *accepted_tick_ >= wanted;
}

bool InputQueue::AcceptFront(const Decode& decode) {
  const std::uint64_t tick = samples_.front().head.tick;
  writer_changed_ = false;
  const bool decoded = AcceptEntry(decode);
  fresh_ = accepted_tick_ == tick;
  return decoded;
}

bool InputQueue::AcceptEntry(const Decode& decode) {
  const bool decoded = decode(samples_.front().bytes);
  if (decoded) {
    writer_changed_ |= accepted_tick_ && writer_ != samples_.front().writer;
    writer_ = samples_.front().writer;
    accepted_tick_ = samples_.front().head.tick;
  }
  samples_.pop_front();
  return decoded;
}

void InputQueue::DropAllButNewest() {
  for (; samples_.size() > 1; ++dropped_) samples_.pop_front();
}

void InputQueue::Reset() {
  samples_.clear();
  accepted_tick_.reset();
  fresh_ = writer_changed_ = false;
}

std::optional<HeadOfMessage> InputQueue::front() const {
  if (samples_.empty()) return std::nullopt;
  return samples_.front().head;
}

}  // namespace sinew::node::internal
