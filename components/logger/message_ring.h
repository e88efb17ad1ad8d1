// The newest messages of a recording, in memory, for a recorder that writes only when something
// has happened. Bounded in time and in bytes. Thread: one at a time.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>

#include "components/logger/recorded_files.h"

namespace sinew::logger {

class MessageRing {
 public:
  // span: of reception times. bytes: of payloads and what is kept beside each.
  MessageRing(std::chrono::nanoseconds span, std::size_t bytes) : span_(span), bytes_(bytes) {}

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
  std::deque<RecordedMessage> messages_;
  std::size_t used_ = 0;
  std::uint64_t forgotten_ = 0;
};

}  // namespace sinew::logger
