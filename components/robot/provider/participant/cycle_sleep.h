// The sleep of a cycle until its deadline, which another thread can end.
//
// Threads: one sleeps, any wakes. Neither allocates.
#pragma once

#include <semaphore.h>

#include <cerrno>
#include <cstdint>
#include <ctime>

namespace sinew::provider {

class CycleSleep {
 public:
  CycleSleep() { ::sem_init(&semaphore_, 0, 0); }
  ~CycleSleep() { ::sem_destroy(&semaphore_); }
  CycleSleep(const CycleSleep&) = delete;
  CycleSleep& operator=(const CycleSleep&) = delete;

  void Wake() noexcept { ::sem_post(&semaphore_); }

  // Until this time of CLOCK_MONOTONIC. False: it came. True: woken before, now or since the last
  // sleep, or by a signal.
  bool Until(std::int64_t deadline_ns) noexcept {
    const timespec deadline{deadline_ns / 1'000'000'000,
                            static_cast<long>(deadline_ns % 1'000'000'000)};
    return ::sem_clockwait(&semaphore_, CLOCK_MONOTONIC, &deadline) == 0 || errno == EINTR;
  }

 private:
  sem_t semaphore_;
};

}  // namespace sinew::provider
