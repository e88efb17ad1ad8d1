// What is reported to systemd, with a datagram socket in its place. Times are a tenth of a real
// unit's.
#include "components/topics/node/systemd_link.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "tests/support/notify_socket.h"

namespace sinew::node {
namespace {

using namespace std::chrono_literals;
using sinew::testing::NotifySocket;
using ::testing::Contains;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr auto kWatchdog = 200ms;  // so a beat is reported every 50 ms
constexpr auto kEnough = 10s;      // for something that must come, on a loaded machine
constexpr auto kSilence = 400ms;   // eight beats: for something that must not come

// Beats as a loop of 1 kHz does.
void BeatFor(SystemdLink& link, std::chrono::milliseconds time) {
  const auto end = std::chrono::steady_clock::now() + time;
  while (std::chrono::steady_clock::now() < end) {
    link.Beat();
    std::this_thread::sleep_for(1ms);
  }
}

TEST(SystemdLink, DoesNothingWithoutSystemd) {
  SystemdLink link;
  link.SetStatus("active");
  link.Beat();
  link.SetStopping();
}

TEST(SystemdLink, IsReadyWithTheFirstStateNotBefore) {
  NotifySocket systemd(kWatchdog);
  SystemdLink link;
  BeatFor(link, kSilence);
  EXPECT_THAT(systemd.Collect(0ms), Not(Contains("READY=1")));
  link.SetStatus("configured: waiting for joint_state");
  EXPECT_TRUE(systemd.WaitFor("READY=1", kEnough));
  link.SetStatus("active");
  const auto words = systemd.Collect(kSilence);
  EXPECT_THAT(words, Contains("STATUS=active"));
  EXPECT_THAT(words, Not(Contains("READY=1")));
}

TEST(SystemdLink, TheFirstStateAndReadinessComeTogether) {
  NotifySocket systemd(0us);
  SystemdLink link;
  link.SetStatus("");
  EXPECT_TRUE(systemd.WaitFor("READY=1", kEnough));
}

TEST(SystemdLink, TheWatchdogIsFedWhileTheLoopGoesRound) {
  NotifySocket systemd(kWatchdog);
  SystemdLink link;
  link.SetStatus("active");
  ASSERT_TRUE(systemd.WaitFor("READY=1", kEnough));
  for (int i = 0; i < 5; ++i) {
    BeatFor(link, 60ms);
    EXPECT_TRUE(systemd.WaitFor("WATCHDOG=1", kEnough)) << i;
  }
}

TEST(SystemdLink, TheWatchdogIsFedNoMoreThanFourTimesItsTime) {
  NotifySocket systemd(kWatchdog);
  SystemdLink link;
  const auto start = std::chrono::steady_clock::now();
  BeatFor(link, 1s);
  const auto words = systemd.Collect(0ms);
  const auto passed = std::chrono::steady_clock::now() - start;
  EXPECT_THAT(words, Each("WATCHDOG=1"));
  EXPECT_LE(static_cast<long>(words.size()), passed / (kWatchdog / 4));
  EXPECT_GE(words.size(), 3u);
}

TEST(SystemdLink, ALoopThatHangsIsNotCoveredByItsThread) {
  NotifySocket systemd(kWatchdog);
  SystemdLink link;
  link.SetStatus("active");
  BeatFor(link, 100ms);
  ASSERT_TRUE(systemd.WaitFor("WATCHDOG=1", kEnough));
  // The last beat may still be reported; nothing comes after it.
  std::this_thread::sleep_for(kWatchdog / 2);
  systemd.Collect(0ms);
  EXPECT_THAT(systemd.Collect(kSilence), IsEmpty());
  // A new state does not stand for a beat.
  link.SetStatus("fault");
  EXPECT_THAT(systemd.Collect(kSilence), ElementsAre("STATUS=fault"));
  link.Beat();
  EXPECT_TRUE(systemd.WaitFor("WATCHDOG=1", kEnough));
}

TEST(SystemdLink, WithoutAWatchdogOnlyStatesAreReported) {
  NotifySocket systemd(0us);
  SystemdLink link;
  link.SetStatus("active");
  BeatFor(link, 100ms);
  EXPECT_THAT(systemd.Collect(kSilence), ElementsAre("STATUS=active", "READY=1"));
}

TEST(SystemdLink, TheWatchdogOfAnotherProcessIsNotOurs) {
  NotifySocket systemd(kWatchdog);
  ::setenv("WATCHDOG_PID", "1", 1);
  SystemdLink link;
  BeatFor(link, kSilence);
  EXPECT_THAT(systemd.Collect(0ms), IsEmpty());
}

TEST(SystemdLink, TheWatchdogOfThisProcessIs) {
  NotifySocket systemd(kWatchdog, /*own_process_only=*/true);
  SystemdLink link;
  BeatFor(link, 60ms);
  EXPECT_TRUE(systemd.WaitFor("WATCHDOG=1", kEnough));
}

TEST(SystemdLink, SaysOnceThatItStops) {
  NotifySocket systemd(0us);
  {
    SystemdLink link;
    link.SetStatus("active");
    link.SetStopping();
    link.SetStopping();
  }
  EXPECT_THAT(systemd.Collect(0ms), ElementsAre("STATUS=active", "READY=1", "STOPPING=1"));
}

TEST(SystemdLink, AStateOfTwoLinesStaysOneWord) {
  NotifySocket systemd(0us);
  {
    SystemdLink link;
    link.SetStatus("fault: a\nREADY=0");
  }
  EXPECT_THAT(systemd.Collect(0ms),
              ElementsAre("STATUS=fault: a READY=0", "READY=1", "STOPPING=1"));
}

// Nobody reads: systemd is busy. The kernel's queue is full after some ten words.
TEST(SystemdLink, ASystemdThatDoesNotReadNeverHoldsUpTheLoop) {
  NotifySocket systemd(4ms);
  SystemdLink link;
  for (int i = 0; i < 200; ++i) {  // a call that waited for capacity would wait for ever
    link.Beat();
    link.SetStatus("active " + std::to_string(i));
    std::this_thread::sleep_for(1ms);
  }
  while (!systemd.Collect(50ms).empty()) {  // lets the thread end
  }
}

}  // namespace
}  // namespace sinew::node
