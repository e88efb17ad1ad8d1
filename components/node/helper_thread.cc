#include "components/node/helper_thread.h"

#include <sched.h>

#include <cerrno>
#include <ctime>

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

void BecomeHelper(const char* name) noexcept {
  const sched_param none{};
  ::pthread_setschedparam(::pthread_self(), SCHED_OTHER, &none);  // always allowed
  ::pthread_setname_np(::pthread_self(), name);
}

HelpersBegin::HelpersBegin(const char* name) noexcept {
  ::pthread_getschedparam(::pthread_self(), &policy_, &parameters_);
  ::pthread_getname_np(::pthread_self(), name_, sizeof name_);
  BecomeHelper(name);
}

HelpersBegin::~HelpersBegin() {
  ::pthread_setname_np(::pthread_self(), name_);
  ::pthread_setschedparam(::pthread_self(), policy_, &parameters_);
}

}  // namespace sinew::node::internal
