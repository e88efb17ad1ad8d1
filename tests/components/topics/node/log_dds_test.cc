// The log of a process as a topic. Domain 214. A program of its own: a process has one log.
#include <gtest/gtest.h>
#include <sinew_idl/log.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "components/topics/node/log.h"
#include "components/topics/node/node.h"

namespace sinew::node {
namespace {

using namespace std::chrono_literals;

Options LogNode(const std::string& name, int domain) {
  Options options;
  options.component = options.name = name;
  options.domain_id = domain;
  return options;
}

// Once: 4 lines, of which one is of level debug.
void LogFourLines() {
  static const bool once = [] {
    internal::StartLog("talks", "debug");
    return true;
  }();
  ASSERT_TRUE(once);
  spdlog::debug("stays here");
  spdlog::info("one");
  spdlog::warn("two");
  spdlog::error("three \x1b[2J");
  ASSERT_TRUE(internal::FlushLog(10s));
}

TEST(LogDds, LinesFromBeforeTheNodeReachALateReaderInTheirOrder) {
  LogFourLines();
  Node talks(LogNode("talks", 214));
  talks.SetCycle(7, 8, 9, msg::Origin::kSim);
  EXPECT_FALSE(internal::LogIsUnsent());
  Node late(LogNode("late", 214));
  auto reader = late.MakeReader(kLog);
  std::vector<msg::LogLine> lines;
  const auto end = std::chrono::steady_clock::now() + 20s;
  while (lines.size() < 3 && std::chrono::steady_clock::now() < end) {
    if (const auto line = reader.WaitNext(100ms)) lines.push_back(*line);
  }
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[0].text, "one");
  EXPECT_EQ(lines[0].name, "talks");
  EXPECT_EQ(lines[0].level, msg::LogLevel::kInfo);
  EXPECT_EQ(lines[1].level, msg::LogLevel::kWarning);
  EXPECT_EQ(lines[2].level, msg::LogLevel::kError);
  EXPECT_EQ(lines[2].text, "three \x1b[2J");
  EXPECT_LE(lines[0].time_ns, lines[2].time_ns);

  spdlog::warn("in a cycle");
  const auto now = reader.WaitNext(20s);
  ASSERT_TRUE(now.has_value());
  EXPECT_EQ(now->text, "in a cycle");
  EXPECT_EQ(now->header.tick, 8u);
}

// The thread that sends.
void TakeTooMany() {
  while (internal::NextLogLine()) {
  }
  spdlog::warn("of the thread that sends: it would go round for ever");
  ASSERT_TRUE(internal::FlushLog(10s));
  EXPECT_FALSE(internal::NextLogLine().has_value());
  std::thread([] {
    for (int line = 0; line < 300; ++line) spdlog::info("{}", line);
  }).join();
  ASSERT_TRUE(internal::FlushLog(10s));
  const auto first = internal::NextLogLine();
  ASSERT_TRUE(first.has_value());
  EXPECT_EQ(first->text, "45 lines of the log were not sent: they came too fast");
  EXPECT_EQ(first->level, msg::LogLevel::kWarning);
  const auto next = internal::NextLogLine();
  ASSERT_TRUE(next.has_value());
  EXPECT_EQ(next->text, "45");
  while (internal::NextLogLine()) {
  }
}

TEST(LogDds, MoreThanCanWaitIsCountedAndTheThreadThatSendsIsNotHeard) {
  LogFourLines();
  std::thread(&TakeTooMany).join();
}

}  // namespace
}  // namespace sinew::node
