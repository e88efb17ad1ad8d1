#include "components/topics/node/sample_queue.h"

#include <utility>

namespace sinew::node::internal {

bool SampleQueue::Push(Sample* sample) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const bool full = samples_.size() >= limit_;
  if (full) {
    ++dropped_;
    spare_.push_back(std::move(samples_.front().bytes));
    samples_.pop_front();
  }
  samples_.push_back(std::move(*sample));
  sample->bytes = Bytes();
  if (!spare_.empty()) {
    sample->bytes = std::move(spare_.back());
    spare_.pop_back();
  }
  return !full;
}

std::uint64_t SampleQueue::dropped() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return dropped_;
}

std::optional<Sample> SampleQueue::TakeNext() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (samples_.empty()) return std::nullopt;
  Sample sample = std::move(samples_.front());
  samples_.pop_front();
  return sample;
}

std::optional<Sample> SampleQueue::TakeLatest() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (samples_.empty()) return std::nullopt;
  Sample sample = std::move(samples_.back());
  samples_.clear();
  return sample;
}

bool SampleQueue::empty() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return samples_.empty();
}

}  // namespace sinew::node::internal
