// How late the machine is: a thread on each core that asks to run every millisecond and notes by
// how much it was late at most. What a bound on time may add on a machine that stalls. At the
// highest priority where that is allowed. A core can stall alone (another machine takes it, or
// Linux throttles its real-time threads), so one thread is not enough. Threads: their own;
// Latest_ms and Take_ms from the owner's.
#pragma once

#include <pthread.h>
#include <sched.h>

#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

namespace sinew::testing {

class Witness {
 public:
  Witness() {
    cpu_set_t allowed;
    if (::sched_getaffinity(0, sizeof allowed, &allowed) != 0) CPU_ZERO(&allowed);
    for (std::size_t cpu = 0; cpu < CPU_SETSIZE; ++cpu) {
      if (CPU_ISSET(cpu, &allowed)) threads_.emplace_back([this, cpu] { Watch(cpu); });
    }
  }
  ~Witness() {
    ended_ = true;
    for (std::thread& thread : threads_) thread.join();
  }
  Witness(const Witness&) = delete;
  Witness& operator=(const Witness&) = delete;

  double Latest_ms() const { return latest_ms_; }
  // The same, and begins anew.
  double Take_ms() { return latest_ms_.exchange(0.0); }

 private:
  void Watch(std::size_t cpu) {
    cpu_set_t cpus;
    CPU_ZERO(&cpus);
    CPU_SET(cpu, &cpus);
    (void)::pthread_setaffinity_np(::pthread_self(), sizeof cpus, &cpus);
    sched_param parameters{.sched_priority = 90};
    (void)::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &parameters);
    auto next = std::chrono::steady_clock::now();
    while (!ended_) {
      next += std::chrono::milliseconds(1);
      std::this_thread::sleep_until(next);
      const std::chrono::duration<double, std::milli> late =
          std::chrono::steady_clock::now() - next;
      double latest_ms = latest_ms_;
      while (late.count() > latest_ms &&
             !latest_ms_.compare_exchange_weak(latest_ms, late.count())) {
      }
      if (late.count() > 1.0) next = std::chrono::steady_clock::now();
    }
  }

  std::atomic<bool> ended_{false};
  std::atomic<double> latest_ms_{0.0};
  std::vector<std::thread> threads_;
};

}  // namespace sinew::testing
