#include "components/topics/node/helper_thread.h"

#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <ctime>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>

namespace sinew::node::internal {

PriorityMutex::PriorityMutex() {
  pthread_mutexattr_t attributes;
  ::pthread_mutexattr_init(&attributes);
  ::pthread_mutexattr_setprotocol(&attributes, PTHREAD_PRIO_INHERIT);
  ::pthread_mutex_init(&mutex_, &attributes);
  ::pthread_mutexattr_destroy(&attributes);
}

void WakeUp::Wait() noexcept {
  while (::sem_wait(&semaphore_) != 0 && errno == EINTR) {
  }
}

bool WakeUp::WaitUntil(std::chrono::steady_clock::time_point end) noexcept {
  const auto since_epoch =
      std::chrono::duration_cast<std::chrono::nanoseconds>(end.time_since_epoch()).count();
  const timespec time{static_cast<std::time_t>(since_epoch / 1'000'000'000),
                      static_cast<long>(since_epoch % 1'000'000'000)};
  int result = 0;
  while ((result = ::sem_clockwait(&semaphore_, CLOCK_MONOTONIC, &time)) != 0 && errno == EINTR) {
  }
  return result == 0;
}

namespace {

enum class Duty { kHelper, kWriter, kResender, kDiscovery, kTimers };

// The kernel's ids of the threads that are not raised like the others. Held while policies change,
// so that a thread is raised before it gets its duty or not at all. Never destroyed: helpers may
// outlive main().
struct Duties {
  std::mutex mutex;
  std::map<pid_t, Duty> threads;
  std::optional<cpu_set_t> process_cpus;  // once the others were raised
};

Duties& TheDuties() {
  static auto* const kDuties = new Duties;
  return *kDuties;
}

// Ids are used again.
struct UntilThreadEnds {
  ~UntilThreadEnds() {
    Duties& duties = TheDuties();
    const std::lock_guard<std::mutex> lock(duties.mutex);
    duties.threads.erase(::gettid());
  }
};

int SetFifo(pid_t thread, int priority) noexcept {
  const sched_param parameters{.sched_priority = priority};
  return ::sched_setscheduler(thread, SCHED_FIFO, &parameters) == 0 ? 0 : errno;
}

int PriorityOf(Duty duty) noexcept {
  switch (duty) {
    case Duty::kHelper:
      return 0;
    case Duty::kWriter:
      return kWriterPriority;
    case Duty::kResender:
      return kResenderPriority;
    case Duty::kDiscovery:
      return kDiscoveryPriority;
    case Duty::kTimers:
      return kTimerPriority;
  }
  return 0;
}

// An error, or 0.
int Raise(const Duties& duties, pid_t thread, int priority, const cpu_set_t* cpus) {
  const auto duty = duties.threads.find(thread);
  if (duty != duties.threads.end()) {
    priority = std::min(priority, PriorityOf(duty->second));
    if (duty->second != Duty::kTimers) return SetFifo(thread, priority);
  }
  // In this order: on a core that real-time threads keep busy it is one of them already.
  const int error = SetFifo(thread, priority);
  if (error != 0 || cpus == nullptr) return error;
  return ::sched_setaffinity(thread, sizeof *cpus, cpus) == 0 ? 0 : errno;
}

void Take(Duty duty, const char* name) noexcept {
  Duties& duties = TheDuties();
  const std::lock_guard<std::mutex> lock(duties.mutex);
  duties.threads[::gettid()] = duty;
  ::pthread_setname_np(::pthread_self(), name);
  static thread_local const UntilThreadEnds kUntilThreadEnds;
  if (duty != Duty::kDiscovery && duty != Duty::kTimers) {
    const sched_param none{};
    ::pthread_setschedparam(::pthread_self(), SCHED_OTHER, &none);  // always allowed
  }
  if (!duties.process_cpus) return;  // RaiseThreads will see it
  if (duty != Duty::kTimers) {
    (void)::sched_setaffinity(0, sizeof(cpu_set_t), &*duties.process_cpus);
  }
  if (duty != Duty::kHelper) (void)SetFifo(0, PriorityOf(duty));
}

}  // namespace

void BecomeHelper(const char* name) noexcept { Take(Duty::kHelper, name); }
void BecomeWriter(const char* name) noexcept { Take(Duty::kWriter, name); }
void BecomeResender() noexcept { Take(Duty::kResender, "dds-resend"); }
void BecomeDiscovery() noexcept { Take(Duty::kDiscovery, "dds-discovery"); }
void BecomeTimers() noexcept { Take(Duty::kTimers, "dds-timers"); }

int RaiseThreads(int priority, std::span<const int> cpus) {
  cpu_set_t own, all;
  CPU_ZERO(&own);
  for (const int cpu : cpus) CPU_SET(static_cast<std::size_t>(cpu), &own);
  if (::sched_getaffinity(0, sizeof all, &all) != 0) return errno;
  Duties& duties = TheDuties();
  const std::lock_guard<std::mutex> lock(duties.mutex);
  duties.process_cpus = all;
  // The caller first: nobody keeps it from raising the others. Then again for those that a thread
  // has started meanwhile which was not raised yet.
  const cpu_set_t* const bound = cpus.empty() ? nullptr : &own;
  if (!duties.threads.contains(::gettid())) {
    if (const int error = Raise(duties, ::gettid(), priority, bound); error != 0) return error;
  }
  for (bool raised = true; raised;) {
    raised = false;
    for (const auto& entry : std::filesystem::directory_iterator("/proc/self/task")) {
      const pid_t thread = std::stoi(entry.path().filename().string());
      const auto duty = duties.threads.find(thread);
      const bool helps = duty != duties.threads.end() && duty->second == Duty::kHelper;
      if (helps || ::sched_getscheduler(thread) == SCHED_FIFO) continue;
      const int error = Raise(duties, thread, priority, bound);
      if (error != 0 && error != ESRCH) return error;  // else it has ended
      raised |= error == 0;
    }
  }
  return 0;
}

}  // namespace sinew::node::internal
