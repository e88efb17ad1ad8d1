// Wakes the one thread that waits on a node.
//
// Threads: any thread calls Notify (DDS reception threads do); one thread waits. No allocation.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>

namespace sinew::node::internal {

// A waiter may name the source that it waits for and is not woken by others: every needless wake-up
// costs two context switches, and in lockstep these are most of a tick.
class WakeSignal {
 public:
  void Notify(const void* source);
  // Waits for news of `source`, or of anything when it is null. True: there was some since the last
  // wait.
  bool Wait(std::chrono::microseconds timeout, const void* source = nullptr);

 private:
  std::mutex mutex_;
  std::condition_variable condition_;
  const void* awaited_ = nullptr;
  bool waiting_ = false;
  bool raised_ = false;
};

}  // namespace sinew::node::internal
