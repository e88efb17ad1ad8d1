// Which threads of a participant in real time are under SCHED_FIFO.
#include <gtest/gtest.h>
#include <pthread.h>
#include <sched.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <span>
#include <string>
#include <thread>

#include "components/topics/node/helper_thread.h"
#include "components/topics/node/node.h"
#include "tests/support/realtime.h"
#include "tests/support/skip.h"

namespace sinew::node {
namespace {

// By thread id: the names of the threads of this process.
std::map<pid_t, std::string> ThreadsOfThisProcess() {
  std::map<pid_t, std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/task")) {
    std::ifstream file(entry.path() / "comm");
    std::getline(file, names[std::atoi(entry.path().filename().c_str())]);
  }
  return names;
}

class UnderFifo {
 public:
  UnderFifo() {
    const sched_param parameters{.sched_priority = 2};
    ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &parameters);
  }
  ~UnderFifo() {
    const sched_param none{};
    ::pthread_setschedparam(::pthread_self(), SCHED_OTHER, &none);
  }
};

Node MakeNode() {
  Options options;
  options.component = options.name = "real";
  options.domain_id = 176;
  return Node(options);
}

struct Threads {
  std::size_t under_fifo = 0;
  std::multiset<std::string> out_of_fifo;
  std::multiset<std::string> names;
};

// Those that were not there before.
Threads ThreadsSince(const std::map<pid_t, std::string>& before) {
  Threads threads;
  for (const auto& [thread, name] : ThreadsOfThisProcess()) {
    if (before.contains(thread)) continue;
    threads.names.insert(name);
    if (::sched_getscheduler(thread) == SCHED_FIFO) {
      ++threads.under_fifo;
    } else {
      threads.out_of_fifo.insert(name);
    }
  }
  return threads;
}

// A thread has its name as soon as its duty is known: one that is raised before that lowers itself
// when it runs next.
Threads WithHelpersSince(const std::map<pid_t, std::string>& before) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  Threads threads = ThreadsSince(before);
  const auto all_there = [&threads] {
    return threads.names.contains("dds-resend") && threads.names.contains("sinew-status") &&
           threads.names.contains("dds-timers") && threads.names.count("dds-discovery") >= 2;
  };
  while (std::chrono::steady_clock::now() < end && !all_there()) {
    std::this_thread::yield();
    threads = ThreadsSince(before);
  }
  return threads;
}

int FirstOf(const cpu_set_t& cpus) {
  for (std::size_t cpu = 0; cpu < CPU_SETSIZE; ++cpu) {
    if (CPU_ISSET(cpu, &cpus)) return static_cast<int>(cpu);
  }
  return -1;
}

constexpr int kPriority = internal::kTimerPriority + 2;
constexpr std::size_t kReceptionAndTimers = 4;  // a reception thread per socket

// It spins while another thread holds a writer's mutex. Two of them at a real-time priority took
// both cores of a machine for good, from the thread that held it too.
TEST(ThreadsDds, WhatRetransmitsIsOutOfFifoAndReceptionIsNot) {
  SKIP_WITHOUT_KERNEL(sinew::testing::MayBecomeRealtime(), "SCHED_FIFO for who runs this");
  const auto before = ThreadsOfThisProcess();
  const UnderFifo fifo;
  Node node = MakeNode();
  auto writer = node.MakeWriter(kOperatorCommand);  // reliable

  const Threads threads = WithHelpersSince(before);
  EXPECT_EQ(threads.out_of_fifo.count("dds-resend"), 1u);
  EXPECT_GE(threads.under_fifo, kReceptionAndTimers);
}

// What writes beside the cycle holds a mutex through which all pass that a participant sends: it is
// under SCHED_FIFO as well, below the cycles, and what spins on mutexes is below all that hold one.
TEST(ThreadsDds, StartUpIsOutOfFifoAndOnlyHelpersStayOut) {
  SKIP_WITHOUT_KERNEL(sinew::testing::MayBecomeRealtime(), "SCHED_FIFO for who runs this");
  const auto before = ThreadsOfThisProcess();
  Node node = MakeNode();
  auto writer = node.MakeWriter(kOperatorCommand);
  const Threads at_start = WithHelpersSince(before);
  EXPECT_EQ(at_start.under_fifo, 0u);

  cpu_set_t all;
  ASSERT_EQ(::sched_getaffinity(0, sizeof all, &all), 0);
  const int core = FirstOf(all);
  ASSERT_EQ(internal::RaiseThreads(kPriority, std::span(&core, 1)), 0);
  const Threads raised = ThreadsSince(before);
  EXPECT_EQ(::sched_getscheduler(0), SCHED_FIFO) << "who asked for it too";
  const std::map<std::string, int> beside = {{"dds-discovery", internal::kDiscoveryPriority},
                                             {"dds-resend", internal::kResenderPriority},
                                             {"sinew-status", internal::kWriterPriority}};
  std::size_t timers = 0;
  for (const auto& [thread, name] : ThreadsOfThisProcess()) {
    if (before.contains(thread)) continue;
    cpu_set_t may_use;
    ASSERT_EQ(::sched_getaffinity(thread, sizeof may_use, &may_use), 0);
    const bool cycles = ::sched_getscheduler(thread) == SCHED_FIFO && !beside.contains(name);
    EXPECT_EQ(CPU_COUNT(&may_use), cycles ? 1 : CPU_COUNT(&all)) << name;
    sched_param parameters{};
    ASSERT_EQ(::sched_getparam(thread, &parameters), 0);
    if (const auto found = beside.find(name); found != beside.end()) {
      EXPECT_EQ(parameters.sched_priority, found->second) << name;
    } else if (name == "dds-timers") {
      ++timers;
      EXPECT_EQ(parameters.sched_priority, internal::kTimerPriority);
    } else if (cycles) {
      EXPECT_EQ(parameters.sched_priority, kPriority) << name;
    }
  }
  EXPECT_EQ(timers, 1u);
  EXPECT_GE(raised.names.count("dds-discovery"), 2u) << "multicast and unicast";
  EXPECT_EQ(raised.out_of_fifo, std::multiset<std::string>());
  EXPECT_EQ(raised.under_fifo, at_start.out_of_fifo.size());
  EXPECT_LT(internal::kResenderPriority, internal::kWriterPriority);
  EXPECT_GE(raised.under_fifo, kReceptionAndTimers);
  const sched_param none{};
  ::pthread_setschedparam(::pthread_self(), SCHED_OTHER, &none);
  std::thread([&] {
    internal::BecomeHelper("late");
    cpu_set_t may_use;
    ASSERT_EQ(::sched_getaffinity(0, sizeof may_use, &may_use), 0);
    EXPECT_EQ(CPU_COUNT(&may_use), CPU_COUNT(&all)) << "a helper is on any core";
  }).join();
  ::sched_setaffinity(0, sizeof all, &all);
}

}  // namespace
}  // namespace sinew::node
