// The newest messages of a recording, in memory, for a recorder that writes only when something
// has happened. Bounded in time and in bytes. What it forgets is handed to the caller, oldest
// first. Thread: one at a time.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <utility>

#include "components/record/logger/recorded_message.h"

namespace sinew::logger {

class MessageRing {
 public:
  using Forgotten = std::function<void(const RecordedMessage&)>;

  // span: of reception times. bytes: of payloads and what is kept beside each. forget: called for
  // each message that is forgotten, if given.
  MessageRing(std::chrono::nanoseconds span, std::size_t bytes, Forgotten forget = {})
      : span_(span), bytes_(bytes), forget_(std::move(forget)) {}

  void Push(RecordedMessage message);    // what is older than the span, or too much, is forgotten
  std::optional<RecordedMessage> Pop();  // the oldest
  std::size_t size() const { return messages_.size(); }
  // Messages within the span that did not fit the bytes: what is here is shorter than the span.
  std::uint64_t forgotten() const { return forgotten_; }

 private:
  static std::size_t SizeOf(const RecordedMessage& message) {
    return sizeof(message) + message.payload.capacity();
  }
  void RemoveOldest();

  const std::chrono::nanoseconds span_;
  const std::size_t bytes_;
  const Forgotten forget_;
  std::deque<RecordedMessage> messages_;
  std::size_t used_ = 0;
  std::uint64_t forgotten_ = 0;
};

}  // namespace sinew::logger
