#include "tools/inspect/peer_checks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sinew::inspect {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

constexpr std::int64_t kMillisecond_ns = 1'000'000;

node::Endpoint Peer(const std::string& name, bool is_writer, bool reliable) {
  node::Endpoint endpoint;
  endpoint.participant = name;
  endpoint.guid = name + "|1";
  endpoint.topic = "imu";
  endpoint.type_name = "T";
  endpoint.is_writer = is_writer;
  endpoint.qos.reliable = reliable;
  return endpoint;
}

TEST(PeerChecks, AWriterAndAReaderThatDoNotMatchAreAFault) {
  const std::vector<node::Endpoint> endpoints = {
      Peer("world", true, false), Peer("watch", false, false), Peer("strict", false, true)};
  EXPECT_THAT(Mismatches(endpoints), SizeIs(1));
  const auto findings = CheckPeers(endpoints, {});
  ASSERT_THAT(findings, SizeIs(1));
  EXPECT_EQ(findings[0].severity, Severity::kFault);
  EXPECT_THAT(findings[0].text, HasSubstr("topic 'imu': 'world' is not heard by 'strict'"));
}

TEST(PeerChecks, MatchingParticipantsAndThoseOfOneProcessAreFine) {
  EXPECT_EQ(CheckPeers({Peer("a", true, true), Peer("b", false, true)}, {})[0].severity,
            Severity::kOk);
  EXPECT_THAT(Mismatches({Peer("a", true, false), Peer("a", false, true)}), SizeIs(0));
}

TEST(PeerChecks, ProblemsOfTheNodeAreFaults) {
  const auto findings = CheckPeers({}, {"topic 'imu': participant 'x' uses type A"});
  ASSERT_THAT(findings, SizeIs(1));
  EXPECT_EQ(findings[0].severity, Severity::kFault);
}

TEST(Openness, WhatIsOpenWithoutKeysIsAWarningThatSaysWhatItMeans) {
  node::Endpoint peer = Peer("surrogate", true, false);
  EXPECT_EQ(CheckOpenness({{"lo"}, false}, {peer}).severity, Severity::kOk);
  peer.addresses = {"192.168.7.2"};
  const Finding open = CheckOpenness({{}, false}, {peer});
  EXPECT_EQ(open.severity, Severity::kWarning);
  EXPECT_THAT(open.text, HasSubstr("'surrogate' on 192.168.7.2; whoever reaches that network can "
                                   "arm, move and stop the robot"));
  EXPECT_THAT(open.advice, HasSubstr("sinew security init"));
  EXPECT_THAT(CheckOpenness({{"eth0"}, false}, {}).text, HasSubstr("this shell on eth0"));
  EXPECT_EQ(CheckOpenness({{"eth0"}, true}, {peer}).severity, Severity::kOk);
}

TEST(Openness, AWireGuardTunnelIsOpenToWhoeverHasAKeyOfIt) {
  const node::internal::InterfaceAddress tunnel{"wg0", "10.9.0.1", 0xffffff00};
  node::Endpoint peer = Peer("surrogate", true, false);
  peer.addresses = {"10.9.0.2"};
  const Finding inside = CheckOpenness({{"wg0"}, false, {tunnel}}, {peer});
  EXPECT_EQ(inside.severity, Severity::kOk);
  EXPECT_THAT(inside.text, HasSubstr("through WireGuard: 'surrogate' on 10.9.0.2, programs of this "
                                     "shell on wg0; whoever has a key of the tunnel, and every "
                                     "user of this host, can command"));
  peer.addresses.emplace_back("192.168.7.2");
  const Finding both = CheckOpenness({{"wg0"}, false, {tunnel}}, {peer});
  EXPECT_EQ(both.severity, Severity::kWarning);
  EXPECT_THAT(both.text, HasSubstr("'surrogate' on 192.168.7.2; whoever reaches"));
}

TEST(Openness, InsideAnIsolatedDeploymentOtherUsersOfTheHostCommandNothing) {
  const Finding alone = CheckOpenness({{}, false, {}, "rig"}, {Peer("surrogate", true, false)});
  EXPECT_EQ(alone.severity, Severity::kOk);
  EXPECT_EQ(alone.text,
            "loopback alone: in the network of deployment 'rig' its user and root, and nobody "
            "else, can command the robot");
}

TEST(Clocks, TheLeastDelayBoundsTheOffset) {
  // Delays of 1 to 9 ms over a clock that is 50 ms ahead.
  std::vector<ClockSample> samples;
  for (int k = 1; k < 10; ++k) {
    samples.push_back({"robot", 50 * kMillisecond_ns, k * kMillisecond_ns});
  }
  const auto ahead = CheckClocks(samples, "desk");
  ASSERT_THAT(ahead, SizeIs(1));
  EXPECT_EQ(ahead[0].severity, Severity::kWarning);
  EXPECT_EQ(ahead[0].text, "the clock of host 'robot' is ahead of this one by at least 49.0 ms");
}

TEST(Clocks, LateMessagesOfLoadAreNoOffsetWhenOneIsOnTime) {
  const auto fine =
      CheckClocks({{"robot", 0, 900 * kMillisecond_ns}, {"robot", 0, 300'000}}, "desk");
  EXPECT_EQ(fine[0].severity, Severity::kOk);
  EXPECT_THAT(fine[0].text, HasSubstr("host 'robot': messages arrive 0.30 ms after"));
  const auto late = CheckClocks({{"robot", 0, 900 * kMillisecond_ns}}, "desk");
  EXPECT_EQ(late[0].severity, Severity::kWarning);
  EXPECT_THAT(late[0].text, HasSubstr("host 'robot' is behind this one by at most 900.0 ms"));
  EXPECT_THAT(late[0].advice, HasSubstr("chrony"));
}

TEST(Clocks, AMessageFromHistoryIsNotCompared) {
  const ClockSample old{"robot", 0, 60'000 * kMillisecond_ns, true};
  const auto alone = CheckClocks({old}, "desk");
  ASSERT_THAT(alone, SizeIs(1));
  EXPECT_EQ(alone[0].severity, Severity::kNote);
  EXPECT_THAT(alone[0].text, HasSubstr("host 'robot': its clock was not compared"));
  EXPECT_EQ(CheckClocks({old, {"robot", 0, kMillisecond_ns}}, "desk")[0].severity, Severity::kOk);
}

TEST(Clocks, WithoutAnyMessageNothingIsSaidOfTheHosts) {
  const auto findings = CheckClocks({}, "desk");
  ASSERT_THAT(findings, SizeIs(1));
  EXPECT_EQ(findings[0].severity, Severity::kNote);
  EXPECT_THAT(findings[0].text, HasSubstr("no component_status was received"));
}

TEST(Clocks, OfThisHostNothingIsCompared) {
  const auto findings = CheckClocks({{"desk", 0, -900 * kMillisecond_ns}}, "desk");
  ASSERT_THAT(findings, SizeIs(1));
  EXPECT_EQ(findings[0].severity, Severity::kOk);
}

TEST(Losses, MoreThanTwoInAHundredAreAWarning) {
  const auto findings = CheckLosses(
      {{"joint_state of host 'robot'", 500, 10}, {"ticks", 500, 11}, {"nothing", 0, 0}});
  ASSERT_THAT(findings, SizeIs(2)) << "what was not heard was not measured";
  EXPECT_EQ(findings[0].severity, Severity::kOk);
  EXPECT_EQ(findings[0].text, "joint_state of host 'robot': 10 of 500 lost (2.0 %)");
  EXPECT_EQ(findings[1].severity, Severity::kWarning);
  EXPECT_THAT(findings[1].text, HasSubstr("11 of 500 lost (2.2 %)"));
}

}  // namespace
}  // namespace sinew::inspect
