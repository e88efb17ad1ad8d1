#include "components/topics/node/realtime.h"

#include <pthread.h>
#include <sched.h>
#include <spdlog/spdlog.h>
#include <sys/mman.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "components/base/config/config.h"
#include "components/topics/node/helper_thread.h"

namespace sinew::node {

// Order in which participants may delay each other: along the chain of a tick the one that is
// awaited at the end comes first, since it bounds how late a command is whatever the others do.
// Below the threads of the kernel for interrupts (50), and below the units' LimitRTPRIO.
const std::vector<PriorityRule>& PriorityRules() {
  static const std::vector<PriorityRule> kRules = {
      {"estop", 48, "stops the robot whatever else runs"},
      {"can-bus", 46, "the bus: hardware to everybody else", true},
      {"virtual-axes", 46, "the motor controllers: hardware to everybody else", true},
      {"can-bridge", 44, "state provider: the cycle's timer, guard and motors off"},
      {"compose", 44, "state provider with others in its thread"},
      {"surrogate", 44, "state provider"},
      {"world", 44, "state provider"},
      {"control", 40, "the provider waits for its command"},
      {"reference", 36, "control waits for it"},
      {"regime", 34, "control waits for it"},
      {"esn", 32, "control waits for it, and goes on without it"},
      {"pneumatics", 31, "valves: slower than a cycle, and nobody waits for them"},
      {"rls", 30, "its readout is used one tick later"},
      {"recorded-reference", 36, "stands in for reference"},
      {"regime-truth", 34, "stands in for regime"},
      {"inverse-dynamics", 32, "stands in for esn"},
      {"ideal-pressure", 31, "stands in for pneumatics"},
      {"frozen-readout", 30, "stands in for rls"},
      {"residual", 0, "observer"},
      {"performance", 0, "observer"},
      {"view", 0, "observer; its page may be slow"},
      {"logger", 0, "observer, and waits for its disk"},
      {"player", 0, "observer of a file; what it sends is no live command"},
      {"", 28, "a kind that is not in this table: below all that are"},
  };
  return kRules;
}

const PriorityRule& PriorityOf(std::string_view component) {
  const std::vector<PriorityRule>& rules = PriorityRules();
  for (const PriorityRule& rule : rules) {
    if (rule.component == component) return rule;
  }
  return rules.back();
}

namespace {

// The first thread's own stack grows while it is used: its pages are touched once, so that they are
// there and locked. Another thread's is small and there.
void TouchStack() {
  std::array<volatile char, kThreadStackBytes / 2> stack;
  for (std::size_t i = 0; i < stack.size(); i += 1024) stack[i] = 0;
}

[[noreturn]] void Refused(const std::string& what, int error, const std::string& remedy) {
  throw std::runtime_error("--realtime: " + what + " (" + std::strerror(error) + "); " + remedy);
}

[[noreturn]] void Refused(int priority, int error) {
  Refused("SCHED_FIFO " + std::to_string(priority) + " refused", error,
          "run as root or raise rtprio in /etc/security/limits.conf");
}

// Rule and cores that BeginRealtime will give; written before g_to_begin is.
struct Prepared {
  const PriorityRule* rule = nullptr;
  std::vector<int> cpus;
};
Prepared g_prepared;
std::atomic<bool> g_to_begin{false};

std::vector<int> UsableCpus() {
  cpu_set_t set;
  CPU_ZERO(&set);
  std::vector<int> usable;
  if (::sched_getaffinity(0, sizeof set, &set) != 0) return usable;  // more than 1024 cores
  for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu) {
    if (CPU_ISSET(cpu, &set)) usable.push_back(cpu);
  }
  return usable;
}

void CheckCpus(const std::vector<int>& cpus, const std::vector<int>& usable) {
  for (const int cpu : cpus) {
    if (std::find(usable.begin(), usable.end(), cpu) != usable.end()) continue;
    throw UsageError(
        fmt::format("--cpu {}: this process may use the cores {}", cpu, fmt::join(usable, ", ")));
  }
}

}  // namespace

int DefaultCpu(std::string_view component, std::span<const int> usable) {
  const bool apart = PriorityOf(component).hardware && usable.size() > 1;
  return usable[usable.size() - (apart ? 2 : 1)];
}

void PrepareRealtime(const std::string& component, const std::vector<int>& cpus) {
  const PriorityRule& rule = PriorityOf(component);
  if (rule.priority == 0) return;
  const std::vector<int> usable = UsableCpus();
  CheckCpus(cpus, usable);
  sched_param parameters{};
  parameters.sched_priority = rule.priority;
  if (::sched_setscheduler(0, SCHED_FIFO, &parameters) != 0) Refused(rule.priority, errno);
  const sched_param none{};
  ::sched_setscheduler(0, SCHED_OTHER, &none);  // always allowed
  pthread_attr_t attributes;
  ::pthread_attr_init(&attributes);
  ::pthread_attr_setstacksize(&attributes, kThreadStackBytes);
  const int error = ::pthread_setattr_default_np(&attributes);
  ::pthread_attr_destroy(&attributes);
  if (error != 0) Refused("stacks of threads cannot be bounded", error, "a fault of the system");
  if (::mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
    Refused("memory cannot be locked", errno, "raise memlock in /etc/security/limits.conf");
  }
  g_prepared = {&rule, cpus};
  if (cpus.empty() && !usable.empty()) g_prepared.cpus = {DefaultCpu(component, usable)};
  g_to_begin = true;
}

void BeginRealtime() {
  if (!g_to_begin.load(std::memory_order_relaxed) || !g_to_begin.exchange(false)) return;
  const PriorityRule& rule = *g_prepared.rule;
  TouchStack();
  const int error = internal::RaiseThreads(rule.priority, g_prepared.cpus);
  if (error != 0) Refused(rule.priority, error);
  spdlog::info("set up: SCHED_FIFO {} ({}), core {}", rule.priority, rule.reason,
               fmt::join(g_prepared.cpus, ", "));
}

}  // namespace sinew::node
