#include "components/record/logger/message_ring.h"

namespace sinew::logger {

void MessageRing::Push(RecordedMessage message) {
  const std::int64_t oldest_ns = message.reception_ns - span_.count();
  used_ += SizeOf(message);
  messages_.push_back(std::move(message));
  while (messages_.front().reception_ns < oldest_ns) RemoveOldest();
  while (used_ > bytes_ && messages_.size() > 1) {
    RemoveOldest();
    ++forgotten_;
  }
}

std::optional<RecordedMessage> MessageRing::Pop() {
  if (messages_.empty()) return std::nullopt;
  RecordedMessage message = std::move(messages_.front());
  used_ -= SizeOf(message);
  messages_.pop_front();
  return message;
}

void MessageRing::RemoveOldest() {
  if (forget_) forget_(messages_.front());
  used_ -= SizeOf(messages_.front());
  messages_.pop_front();
}

}  // namespace sinew::logger
