// What a thread beside the loop needs so that the loop never waits for it: a mutex with priority
// inheritance, a wake-up that never blocks who gives it, and the way out of SCHED_FIFO.
#pragma once

#include <pthread.h>
#include <sched.h>
#include <semaphore.h>

#include <chrono>

namespace sinew::node::internal {

// Whoever holds it runs at the priority of the highest thread that waits for it, so that a helper
// of SCHED_OTHER that is preempted inside delays the loop by its critical section and no longer.
class PriorityMutex {
 public:
  PriorityMutex();
  ~PriorityMutex() { ::pthread_mutex_destroy(&mutex_); }
  PriorityMutex(const PriorityMutex&) = delete;
  PriorityMutex& operator=(const PriorityMutex&) = delete;

  void lock() { ::pthread_mutex_lock(&mutex_); }
  void unlock() { ::pthread_mutex_unlock(&mutex_); }

 private:
  pthread_mutex_t mutex_;
};

// Any thread gives, one waits. What was given before the wait is not lost.
class WakeUp {
 public:
  WakeUp() { ::sem_init(&semaphore_, 0, 0); }
  ~WakeUp() { ::sem_destroy(&semaphore_); }
  WakeUp(const WakeUp&) = delete;
  WakeUp& operator=(const WakeUp&) = delete;

  void Give() noexcept { ::sem_post(&semaphore_); }
  void Wait() noexcept;
  // Returns at the latest at `end`; false: nothing was given.
  bool WaitUntil(std::chrono::steady_clock::time_point end) noexcept;

 private:
  sem_t semaphore_;
};

// The calling thread leaves SCHED_FIFO, which it inherited. `name`: of at most 15 characters, shown
// by `ps -L`.
void BecomeHelper(const char* name) noexcept;

// While it lives the calling thread is out of SCHED_FIFO and bears `name` (at most 15 characters),
// and so do threads that it starts, for good.
class HelpersBegin {
 public:
  explicit HelpersBegin(const char* name) noexcept;
  ~HelpersBegin();
  HelpersBegin(const HelpersBegin&) = delete;
  HelpersBegin& operator=(const HelpersBegin&) = delete;

 private:
  int policy_ = 0;
  sched_param parameters_{};
  char name_[16] = {};
};

}  // namespace sinew::node::internal
