// A bounded queue from many threads to one that never makes a writer wait for the reader: a full
// queue drops its oldest entry and counts it.
//
// Threads: any thread pushes, one takes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

#include "components/topics/node/helper_thread.h"

namespace sinew::node::internal {

template <class Entry>
class OverrunQueue {
 public:
  explicit OverrunQueue(std::size_t limit) : limit_(limit) {}  // entries, at least 1

  void Push(Entry entry) {
    {
      const std::lock_guard<PriorityMutex> lock(mutex_);
      if (entries_.size() >= limit_) {
        entries_.pop_front();
        ++dropped_;
      }
      entries_.push_back(std::move(entry));
      ++pushed_;
    }
    wake_up_.Give();
  }

  // Blocks for the oldest entry.
  Entry Take() {
    while (true) {
      if (std::optional<Entry> entry = TryTake()) return std::move(*entry);
      wake_up_.Wait();
    }
  }

  // The oldest entry, where there is one.
  std::optional<Entry> TryTake() {
    const std::lock_guard<PriorityMutex> lock(mutex_);
    if (entries_.empty()) return std::nullopt;
    std::optional<Entry> entry(std::move(entries_.front()));
    entries_.pop_front();
    return entry;
  }

  std::uint64_t pushed() const {
    const std::lock_guard<PriorityMutex> lock(mutex_);
    return pushed_;
  }
  std::uint64_t dropped() const {
    const std::lock_guard<PriorityMutex> lock(mutex_);
    return dropped_;
  }

 private:
  const std::size_t limit_;
  mutable PriorityMutex mutex_;
  WakeUp wake_up_;
  std::deque<Entry> entries_;
  std::uint64_t pushed_ = 0, dropped_ = 0;
};

}  // namespace sinew::node::internal
