// A node under systemd: readiness comes with the configured state, the watchdog from the loop.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sinew_idl/joint.h>

#include <thread>

#include "components/topics/node/node.h"
#include "components/topics/node/tick_loop.h"
#include "tests/support/notify_socket.h"

namespace sinew::node {
namespace {

using namespace std::chrono_literals;
using sinew::testing::NotifySocket;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr auto kUnitWatchdog = 400ms;
constexpr auto kLongEnough = 20s;

Options UnderSystemd(const std::string& name, int domain) {
  Options options;
  options.component = options.name = name;
  options.domain_id = domain;
  return options;
}

msg::JointState JointsAtTick(std::uint64_t tick, bool last = false) {
  msg::JointState state;
  state.header.session_id = 9;
  state.header.tick = tick;
  state.period_s = 0.001;
  state.last_tick = last;
  state.joint_count = 1;
  return state;
}

TEST(SystemdDds, ALoopIsReadyWhenConfiguredFedWhileItRunsAndSilentWhenItHangs) {
  Node provider(UnderSystemd("provider", 135));  // not under systemd: the socket comes after it
  auto writer = provider.MakeWriter(kJointState);

  NotifySocket systemd(kUnitWatchdog);
  auto node = std::make_unique<Node>(UnderSystemd("loop", 135));
  EXPECT_THAT(systemd.Collect(kUnitWatchdog), Not(Contains("READY=1")))
      << "a node that exists is not configured yet";

  StopFlag stop;
  std::atomic<bool> hang{false}, hangs{false};
  std::atomic<int> cycles{0};
  std::thread participant([&] {
    TickLoop loop(*node, stop);
    loop.AddInput(kJointState);
    while (loop.Next()) {
      ++cycles;
      while (hang) {
        hangs = true;
        std::this_thread::sleep_for(1ms);
      }
    }
  });
  EXPECT_TRUE(systemd.WaitFor("STATUS=configured: waiting for joint_state", kLongEnough));
  EXPECT_TRUE(systemd.WaitFor("READY=1", kLongEnough));
  EXPECT_TRUE(systemd.WaitFor("WATCHDOG=1", kLongEnough)) << "waiting for a provider is no hanging";

  std::uint64_t tick = 0;
  const auto publish_until = [&](const auto& condition) {
    const auto end = std::chrono::steady_clock::now() + kLongEnough;
    while (std::chrono::steady_clock::now() < end) {
      if (condition()) return true;
      EXPECT_EQ(writer.Write(JointsAtTick(tick++)), WriteStatus::kOk);
      std::this_thread::sleep_for(2ms);
    }
    return false;
  };
  ASSERT_TRUE(publish_until([&] { return cycles > 0; }));
  EXPECT_TRUE(systemd.WaitFor("STATUS=active", kLongEnough));
  systemd.Collect(0ms);
  const auto start = std::chrono::steady_clock::now();
  publish_until([&] { return std::chrono::steady_clock::now() - start > 2 * kUnitWatchdog; });
  EXPECT_THAT(systemd.Collect(0ms), Contains("WATCHDOG=1"));

  hang = true;
  ASSERT_TRUE(publish_until([&] { return hangs.load(); }));
  std::this_thread::sleep_for(kUnitWatchdog / 2);  // the last beat is reported
  systemd.Collect(0ms);
  EXPECT_THAT(systemd.Collect(2 * kUnitWatchdog), Not(Contains("WATCHDOG=1")));

  hang = false;
  EXPECT_TRUE(publish_until([&] { return systemd.WaitFor("WATCHDOG=1", 0ms); }));
  ASSERT_EQ(writer.Write(JointsAtTick(tick, /*last=*/true)), WriteStatus::kOk);
  EXPECT_TRUE(systemd.WaitFor("STATUS=stopped: session ended", kLongEnough));
  EXPECT_TRUE(systemd.WaitFor("STOPPING=1", kLongEnough));
  participant.join();
  node.reset();
}

TEST(SystemdDds, AFaultIsReportedInWords) {
  NotifySocket systemd(0us);
  Node node(UnderSystemd("loop", 136));
  node.SetState(Node::State::kFault, "joint 'knee': over-temperature");
  EXPECT_TRUE(systemd.WaitFor("STATUS=fault: joint 'knee': over-temperature", kLongEnough));
}

}  // namespace
}  // namespace sinew::node
