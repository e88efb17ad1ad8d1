// How late the machine is: a thread that asks to run every millisecond and notes by how much it was
// late at most. What a bound on time may add on a machine that stalls. At the highest priority
// where that is allowed. Thread: its own; Latest_ms from the owner's.
#pragma once

#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

namespace sinew::testing {

class Witness {
 public:
  // cpu: where it runs; -1: where the system lets it.
  explicit Witness(int cpu = -1) : thread_([this, cpu] { Watch(cpu); }) {}
  ~Witness() {
    ended_ = true;
    thread_.join();
  }
  Witness(const Witness&) = delete;
  Witness& operator=(const Witness&) = delete;

  double Latest_ms() const { return latest_ms_; }
  // The same, and begins anew.
  double Take_ms() { return latest_ms_.exchange(0.0); }

 private:
  void Watch(int cpu) {
    if (cpu >= 0) {
      cpu_set_t cpus;
      CPU_ZERO(&cpus);
      CPU_SET(static_cast<std::size_t>(cpu), &cpus);
      (void)::pthread_setaffinity_np(::pthread_self(), sizeof cpus, &cpus);
    }
    sched_param parameters{.sched_priority = 90};
    (void)::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &parameters);
    auto next = std::chrono::steady_clock::now();
    while (!ended_) {
      next += std::chrono::milliseconds(1);
      std::this_thread::sleep_until(next);
      const std::chrono::duration<double, std::milli> late =
          std::chrono::steady_clock::now() - next;
      latest_ms_ = std::max(latest_ms_.load(), late.count());
      if (late.count() > 1.0) next = std::chrono::steady_clock::now();
    }
  }

  std::atomic<bool> ended_{false};
  std::atomic<double> latest_ms_{0.0};
  std::thread thread_;
};

}  // namespace sinew::testing
