// --realtime: scheduling, cores, stacks and memory of a process, by the kind of its participant.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sinew::node {

// Priority under SCHED_FIFO of a kind of participant, for all its threads but the helpers (log,
// status, systemd). 0: SCHED_OTHER, and its memory is not locked.
struct PriorityRule {
  std::string_view component;
  int priority;
  std::string_view reason;
  bool hardware = false;  // stands for what has its own processor on a robot
};

// From the highest to the lowest; the last rule, without a name, is for kinds that are not in it.
const std::vector<PriorityRule>& PriorityRules();
const PriorityRule& PriorityOf(std::string_view component);

// Stack of every thread but the first. mlockall() locks the whole stack of a thread, 8 MB by
// default, and a participant has some ten threads. What they call is DDS and our own cycle: no
// recursion, no large arrays; measured under 40 kB. A stack that is too small is a crash at its
// guard page, so there is much to spare.
inline constexpr std::size_t kThreadStackBytes = 512 * 1024;

// Start-up is work of SCHED_OTHER: reading files, memory and discovery would spend the machine's
// share of real-time work (kernel.sched_rt_runtime_us), and Linux then withholds a core from every
// real-time thread for the rest of the second's share. So --realtime has two steps.
//
// First, before the first thread: bounded stacks, locked memory, the kind's priority and cores for
// later. `cpus`: DefaultCpu when empty. Nothing for a kind of priority 0. Throws UsageError for a
// core that the process may not use, std::runtime_error that names the limit which refuses;
// SCHED_FIFO is tried for it.
void PrepareRealtime(const std::string& component, const std::vector<int>& cpus = {});

// The core of the kind's threads in real time, of the ones that may be used (ascending, not empty).
// All participants share one, the last: a tick wakes threads some hundred times, one after the
// other, and to wake one on another core costs several times as much (docs/decisions/0015). What
// stands for hardware has another one, where there is one.
int DefaultCpu(std::string_view component, std::span<const int> usable);

// Second, once: all threads but the helpers, and those that they start from then on. TickLoop does
// it once its participant has settled (ownership.h) or is handed the role, a state provider before
// it speaks to its plant; a loop of another kind calls it when it is set up. Nothing without
// PrepareRealtime, or when it was done. Throws std::runtime_error. Thread: any.
void BeginRealtime();

}  // namespace sinew::node
