// Tools for a thread beside the loop, so that the loop never waits for it: a mutex with priority
// inheritance, a wake-up that never blocks its giver, and the way out of SCHED_FIFO.
#pragma once

#include <pthread.h>
#include <semaphore.h>

#include <chrono>
#include <span>

namespace sinew::node::internal {

// A mutex whose holder runs at the priority of the highest thread that waits for it: a helper of
// SCHED_OTHER that is preempted inside delays the loop by its critical section and no longer.
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

// The calling thread is out of SCHED_FIFO until it ends, on any core of the process, whatever it
// inherited and which thread raises the others. It writes nothing to DDS. `name`: of at most 15
// characters, shown by `ps -L`.
void BecomeHelper(const char* name) noexcept;

// The calling thread writes to DDS beside the loop. What a participant sends passes one mutex,
// which every sender holds: out of SCHED_FIFO it was preempted with it, for up to 37 ms while
// another participant joined, and the loop did not send. Once the process is raised it is below
// every cycle, on any core of the process.
void BecomeWriter(const char* name) noexcept;
inline constexpr int kWriterPriority = 5;

// The same of what DDS sends again. It spins while another thread holds a writer's mutex: below all
// that may hold one.
void BecomeResender() noexcept;
inline constexpr int kResenderPriority = 1;

// The calling thread takes part in discovery, whose bursts (a participant that joins exchanges some
// 40 endpoints with each other one) are no work of a cycle: once the process is raised it is below
// every cycle, on any core of the process.
void BecomeDiscovery() noexcept;
inline constexpr int kDiscoveryPriority = 10;

// The calling thread keeps DDS' timers, the deadlines of topics above all, which every sample sets
// anew: once the process is raised it is below every cycle, on the cores of the others.
void BecomeTimers() noexcept;
inline constexpr int kTimerPriority = 20;  // above discovery: a take-over waits for a deadline

// SCHED_FIFO `priority`, on `cpus` alone (none: wherever they may run), for every thread of the
// process that has no duty of these and is not under SCHED_FIFO already. The error of the one
// that was refused, or 0. Thread: any.
int RaiseThreads(int priority, std::span<const int> cpus);

}  // namespace sinew::node::internal
