// Owners of a topic over DDS, in real time: who joins, is silent, comes back, is handed over.
#include <gtest/gtest.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/operator.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "components/base/types/clock/clock.h"
#include "components/topics/node/endpoint.h"
#include "components/topics/node/node.h"
#include "components/topics/node/other_owner.h"
#include "components/topics/node/ownership.h"
#include "components/topics/node/tick_loop.h"

namespace sinew::node {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

Options OwnerOptions(const std::string& name, int domain) {
  Options options;
  options.component = "control";
  options.name = name;
  options.domain_id = domain;
  return options;
}

// A controller without a loop: writes until it ends or is made silent.
class Controller {
 public:
  Controller(const std::string& name, int domain)
      : node_(OwnerOptions(name, domain)), writer_(node_.MakeWriter(kJointCommand)) {
    thread_ = std::thread([this] {
      while (!ended_) {
        if (!silent_) (void)writer_.Write(msg::JointCommand());
        node_.WaitForData(2ms);
      }
    });
  }
  ~Controller() {
    ended_ = true;
    thread_.join();
  }
  Controller(const Controller&) = delete;
  Controller& operator=(const Controller&) = delete;
  void SetSilent(bool silent) { silent_ = silent; }

 private:
  Node node_;
  Writer<msg::JointCommand> writer_;
  std::atomic<bool> silent_{false}, ended_{false};
  std::thread thread_;
};

class Provider {
 public:
  explicit Provider(int domain)
      : node_(OwnerOptions("provider", domain)),
        reader_(node_.MakeReader(kJointCommand)),
        state_(node_.MakeWriter(kJointState)),
        operator_(node_.MakeWriter(kOperatorCommand)) {}

  // Whose command was the last one.
  std::string Heard() {
    while (reader_.TakeNext()) {
      if (const auto writer = node_.NameOf(reader_.writer())) heard_ = writer->participant;
    }
    return heard_;
  }
  bool WaitUntilHeard(const std::string& name) {
    return WaitUntil([&] { return Heard() == name; });
  }
  bool WaitUntil(const std::function<bool()>& condition) {
    const auto deadline = Clock::now() + 10s;
    while (!condition()) {
      if (Clock::now() > deadline) return false;
      node_.WaitForData(5ms);
    }
    return true;
  }
  std::uint32_t StrengthOf(const std::string& name) {
    for (const Endpoint& endpoint : node_.Endpoints()) {
      if (endpoint.is_writer && endpoint.topic == kJointCommand.name &&
          endpoint.participant == name) {
        return endpoint.strength;
      }
    }
    return 0;
  }
  // The controllers have no loop, so no session: 0.
  void HandOver(const std::string& name, const std::string& role = "control",
                msg::Origin origin = msg::Origin::kLive, std::uint64_t session_id = 0) {
    msg::OperatorCommand command;
    command.header.session_id = session_id;
    command.header.origin = origin;
    command.action = msg::OperatorAction::kHandover;
    command.role = role;
    command.target = name;
    EXPECT_TRUE(WaitUntil([&] { return operator_.matched_readers() >= 2; }));
    (void)operator_.Write(command);
  }

 private:
  Node node_;
  Reader<msg::JointCommand> reader_;
  Writer<msg::JointState> state_;
  Writer<msg::OperatorCommand> operator_;
  std::string heard_;
};

constexpr std::uint32_t kSettled = 1u << 20;  // more than those that join have

struct TwoControllers {
  explicit TwoControllers(int domain)
      : provider(domain), first(std::make_unique<Controller>("first", domain)) {
    EXPECT_TRUE(provider.WaitUntilHeard("first"));
    EXPECT_TRUE(provider.WaitUntil([&] { return provider.StrengthOf("first") > kSettled; }));
    second = std::make_unique<Controller>("second", domain);
    EXPECT_TRUE(provider.WaitUntil([&] { return provider.StrengthOf("second") > kSettled; }));
  }
  Provider provider;
  std::unique_ptr<Controller> first, second;
};

TEST(OwnershipDds, WhoIsStartedLaterStandsByWhateverItsGuid) {
  // Equal strengths would be decided by GUID, which is a coin: eight times.
  const auto toss = [](int domain) {
    TwoControllers rig(domain);
    EXPECT_EQ(rig.provider.Heard(), "first");
    EXPECT_LT(rig.provider.StrengthOf("second"), rig.provider.StrengthOf("first"));
    rig.first.reset();
    ASSERT_TRUE(rig.provider.WaitUntilHeard("second"));
    rig.first = std::make_unique<Controller>("first", domain);
    ASSERT_TRUE(
        rig.provider.WaitUntil([&] { return rig.provider.StrengthOf("first") > kSettled; }));
    EXPECT_EQ(rig.provider.Heard(), "second") << "the primary is back, and stays below";
    EXPECT_LT(rig.provider.StrengthOf("first"), rig.provider.StrengthOf("second"));
  };
  std::vector<std::jthread> tosses;
  for (int domain = 150; domain < 154; ++domain) tosses.emplace_back(toss, domain);
}

TEST(OwnershipDds, TheOperatorHandsOverByRoleNameSessionAndOrigin) {
  TwoControllers rig(154);
  rig.provider.HandOver("second", "esn");
  rig.provider.HandOver("third");
  rig.provider.HandOver("second", "control", msg::Origin::kReplay);
  rig.provider.HandOver("second", "control", msg::Origin::kLive, 77);
  rig.provider.HandOver("first");  // it is the owner already
  // What was refused had its time when this one has worked: commands arrive in order.
  EXPECT_EQ(rig.provider.Heard(), "first");
  const std::uint32_t before = rig.provider.StrengthOf("second");
  rig.provider.HandOver("second");
  ASSERT_TRUE(rig.provider.WaitUntilHeard("second"));
  EXPECT_GT(rig.provider.StrengthOf("second"), before);
  rig.provider.HandOver("first");
  ASSERT_TRUE(rig.provider.WaitUntilHeard("first"));
}

// Who has just begun may not hear its inputs yet: handed the robot, a controller once moved a joint
// by 0.9 rad.
TEST(OwnershipDds, AHandoverWaitsUntilTheNewcomerHasSettled) {
  Provider provider(162);
  Controller first("first", 162);
  ASSERT_TRUE(provider.WaitUntilHeard("first"));
  const auto begin = Clock::now();
  Controller second("second", 162);
  provider.HandOver("second");
  ASSERT_TRUE(provider.WaitUntilHeard("second"));
  EXPECT_GE(Clock::now() - begin, internal::kSettleTime);
}

TEST(OwnershipDds, ASilentOwnerIsReplacedWithinTheDeadlineAndAFewPeriods) {
  TwoControllers rig(155);
  ASSERT_EQ(rig.provider.Heard(), "first");
  rig.first->SetSilent(true);
  EXPECT_TRUE(rig.provider.WaitUntilHeard("second"));
}

// An owner, and another participant that stands by.
struct OwnerAndStandby {
  OwnerAndStandby(int domain, std::uint64_t now)
      : owner(OwnerOptions("first", domain)), node(OwnerOptions("second", domain)) {
    tick.session_id = 9;
    tick.tick = now;
    tick.nominal_period_s = 0.004;
  }
  // The owner says a tick; the ticks that the standby follows then.
  std::vector<std::uint64_t> FollowedAfter(std::uint64_t number) {
    msg::JointCommand command;
    command.header.session_id = 9;
    command.header.tick = number;
    (void)writer.Write(command);
    node.WaitForData(5ms);
    std::vector<std::uint64_t> followed;
    while (const auto heard = other.TakeNext(tick)) followed.push_back(heard->header.tick);
    return followed;
  }
  // Until it is followed.
  bool Follows(std::uint64_t number) {
    const auto end = Clock::now() + 10s;
    while (Clock::now() < end) {
      if (!FollowedAfter(number).empty()) return true;
    }
    return false;
  }

  Node owner, node;
  Writer<msg::JointCommand> writer = owner.MakeWriter(kJointCommand);
  OtherOwner<msg::JointCommand> other{node, kJointCommand};
  Tick tick;
};

// What the owner said while this one was stopped may still wait in the sockets.
TEST(OwnershipDds, AStandbyThatWasStoppedStandsByUntilItKnowsBetter) {
  OwnerAndStandby rig(183, 10);
  ASSERT_TRUE(rig.Follows(10));
  EXPECT_TRUE(rig.other.StandsBy(rig.tick));
  const auto at = [&](std::uint64_t number) {
    rig.tick.tick = number;
    return rig.other.StandsBy(rig.tick);
  };
  EXPECT_TRUE(at(11));
  EXPECT_TRUE(at(400)) << "stopped from 12 to 399";
  EXPECT_TRUE(at(402));
  EXPECT_FALSE(at(407)) << "the owner is silent";
  EXPECT_FALSE(at(900)) << "it did not stand by when it was stopped";
}

// A writer that is stopped while it writes sends that sample when it goes on. A standby reference
// that goes on from one of 1.7 s before asks the joint to be elsewhere by radians.
TEST(OwnershipDds, WhatAnOwnerSaidBeforeItWasStoppedIsNotFollowed) {
  OwnerAndStandby rig(184, 400);
  ASSERT_TRUE(rig.Follows(395)) << "five periods are 20 ms";
  for (const std::uint64_t old : {10u, 394u}) {
    for (int k = 0; k < 20; ++k) {
      for (const std::uint64_t one : rig.FollowedAfter(old)) EXPECT_EQ(one, 395u);
    }
  }
  EXPECT_TRUE(rig.other.StandsBy(rig.tick));
}

// A loop whose thread was stopped sees that ticks are missing; its writers go below, and it takes
// no trigger before the others know.
TEST(OwnershipDds, ALoopThatMissedTicksStandsByWhenItIsBack) {
  Node provider(OwnerOptions("provider", 156));
  auto state = provider.MakeWriter(kJointState);
  auto commands = provider.MakeReader(kJointCommand);
  Node node(OwnerOptions("first", 156));
  StopFlag stop;
  TickLoop loop(node, stop);
  loop.AddInput(kJointState);
  auto writer = node.MakeWriter(kJointCommand);
  Controller second("second", 156);  // joins at the same time: the strengths are as it happens
  const auto strength_of = [&](const std::string& name) {
    for (const Endpoint& endpoint : provider.Endpoints()) {
      if (endpoint.is_writer && endpoint.topic == kJointCommand.name &&
          endpoint.participant == name) {
        return endpoint.strength;
      }
    }
    return std::uint32_t{0};
  };
  // Sends a tick until the loop has it, or ticks from there on until the loop has one.
  const auto step = [&](std::uint64_t number, bool goes_on = false) {
    std::atomic<bool> taken{false};
    std::thread sender([&] {
      for (std::uint64_t sent = number; !taken; sent += goes_on ? 1 : 0) {
        msg::JointState message;
        message.header.session_id = 9;
        message.header.tick = sent;
        message.header.stamp_ns = types::EpochNow_ns();
        message.period_s = 0.004;
        message.joint_count = 1;
        (void)state.Write(message);
        provider.WaitForData(2ms);
      }
    });
    const auto tick = loop.Next();
    taken = true;
    sender.join();
    loop.Publish(writer, msg::JointCommand(), tick.value_or(Tick{}));
    return tick.value_or(Tick{}).tick;
  };
  EXPECT_EQ(step(0), 0u);
  const auto wait_until = [&](const std::function<bool()>& condition) {
    const auto deadline = Clock::now() + 10s;
    while (!condition() && Clock::now() < deadline) provider.WaitForData(5ms);
    return condition();
  };
  auto operators = provider.MakeWriter(kOperatorCommand);
  ASSERT_TRUE(wait_until([&] { return operators.matched_readers() == 2; }));
  msg::OperatorCommand handover;
  handover.header.session_id = 9;
  handover.action = msg::OperatorAction::kHandover;
  handover.role = "control";
  handover.target = "first";
  const auto hand_over = [&] {
    ASSERT_EQ(operators.Write(handover), WriteStatus::kOk);
    ASSERT_TRUE(wait_until([&] {
      return strength_of("second") > kSettled && strength_of("first") > strength_of("second");
    }));
  };
  hand_over();
  EXPECT_EQ(step(5), 5u);  // 20 ms after tick 0: within the deadline
  const std::uint32_t before = strength_of("first");
  EXPECT_GT(before, strength_of("second"));
  EXPECT_GT(step(11, true), 11u);  // 24 ms later
  EXPECT_TRUE(wait_until([&] { return strength_of("first") < strength_of("second"); }));
  EXPECT_LT(strength_of("first"), before);

  // While it is quiet it is handed over to: it goes on at once.
  hand_over();
  std::thread loops([&] {
    while (step(1u << 20, true) < 1u << 20) {  // what is left of the ticks before
    }
  });
  EXPECT_TRUE(wait_until([&] { return strength_of("first") < strength_of("second"); }));
  const auto begin = Clock::now();
  hand_over();
  loops.join();
  EXPECT_LT(Clock::now() - begin, internal::kSettleTime / 2);
}

}  // namespace
}  // namespace sinew::node
