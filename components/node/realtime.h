// --realtime: scheduling, stacks and memory of a process, by the kind of its participant.
#pragma once

#include <cstddef>
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
};

// From the highest to the lowest; the last rule, without a name, is for kinds that are not in it.
const std::vector<PriorityRule>& PriorityRules();
const PriorityRule& PriorityOf(std::string_view component);

// Of every thread but the first. mlockall() locks the whole stack of a thread, 8 MB by default, and
// a participant has some ten threads. What they call is DDS and our own cycle: no recursion, no
// large arrays; measured under 40 kB. A stack that is too small is a crash at its guard page, so
// there is much to spare.
inline constexpr std::size_t kThreadStackBytes = 512 * 1024;

// Before the first thread. Nothing for a kind of priority 0. Throws std::runtime_error that names
// the limit which refuses.
void BecomeRealtime(const std::string& component);

}  // namespace sinew::node
