// Whether processes of a test may run under SCHED_FIFO: a robot in real time on a machine that
// other work keeps busy loses cycles without it.
#pragma once

#include <sched.h>

namespace sinew::testing {

inline bool MayBecomeRealtime() {
  sched_param parameters{.sched_priority = 1};
  if (::sched_setscheduler(0, SCHED_FIFO, &parameters) != 0) return false;
  parameters.sched_priority = 0;
  return ::sched_setscheduler(0, SCHED_OTHER, &parameters) == 0;
}

}  // namespace sinew::testing
