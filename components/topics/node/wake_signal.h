// Wakes the one thread that waits on a node.
//
// Threads: any thread calls Notify (DDS reception threads do); one thread waits. No allocation for
// up to kMostSources sources.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <span>
#include <vector>

namespace sinew::node::internal {

// A waiter names the sources that it waits for and is woken once, when all of them have given news:
// every needless wake-up costs two context switches, and these are most of a cycle.
class WakeSignal {
 public:
  static constexpr std::size_t kMostSources = 32;
  WakeSignal() { raised_.reserve(kMostSources); }

  // News of this source; null ends every wait.
  void Notify(const void* source);
  // Until there was news of all `sources` since the last wait, or of anything when there are none;
  // no longer than the timeout. True: there was.
  bool Wait(std::chrono::microseconds timeout, std::span<const void* const> sources = {});

 private:
  bool Complete() const;  // with mutex_ held

  std::mutex mutex_;
  std::condition_variable condition_;
  std::vector<const void*> raised_;  // since the last wait, each once
  std::span<const void* const> awaited_;
  bool waiting_ = false;
};

}  // namespace sinew::node::internal
