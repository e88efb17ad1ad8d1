// Which threads of a participant in real time are under SCHED_FIFO.
#include <gtest/gtest.h>
#include <pthread.h>
#include <sched.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>

#include "components/node/node.h"
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

// It spins while another thread holds a writer's mutex. Two of them at a real-time priority took
// both cores of a machine for good, from the thread that held it too.
TEST(ThreadsDds, WhatRetransmitsIsOutOfFifoAndReceptionIsNot) {
  SKIP_WITHOUT_KERNEL(sinew::testing::MayBecomeRealtime(), "SCHED_FIFO for who runs this");
  const auto before = ThreadsOfThisProcess();
  const UnderFifo fifo;
  Options options;
  options.component = options.name = "real";
  options.domain_id = 176;
  Node node(options);
  auto writer = node.MakeWriter(kOperatorCommand);  // reliable

  std::size_t under_fifo = 0;
  std::multiset<std::string> out_of_fifo;
  for (const auto& [thread, name] : ThreadsOfThisProcess()) {
    if (before.contains(thread)) continue;
    if (::sched_getscheduler(thread) == SCHED_FIFO) {
      ++under_fifo;
    } else {
      out_of_fifo.insert(name);
    }
  }
  EXPECT_EQ(out_of_fifo.count("dds-resend"), 1u);
  EXPECT_GE(under_fifo, 4u) << "events, and a reception thread per socket";
}

}  // namespace
}  // namespace sinew::node
