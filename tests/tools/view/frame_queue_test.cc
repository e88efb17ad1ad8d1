// A slow client's queue, rates, loads, what an operator asks for, who may command.
#include "tools/view/frame_queue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tools/view/pending_action.h"
#include "tools/view/process_load.h"
#include "tools/view/request_rule.h"
#include "tools/view/topic_rates.h"

namespace sinew::live {
namespace {

using ::testing::HasSubstr;

Frame Data(std::size_t size, unsigned mark) {
  return {"", MessageDataHead(SubscriptionNumber{mark}, 0),
          std::make_shared<const std::vector<std::byte>>(size - sizeof(Frame))};
}
unsigned MarkOf(const Frame& frame) { return std::to_integer<unsigned>(frame.head[1]); }

TEST(FrameQueue, KeepsTheOrderAndCountsNothingWhileItFits) {
  FrameQueue queue(300);
  for (unsigned i = 1; i <= 3; ++i) queue.Push(Data(100, i));
  EXPECT_EQ(queue.waiting_bytes(), 300u);
  for (unsigned i = 1; i <= 3; ++i) EXPECT_EQ(MarkOf(queue.Pop().value()), i);
  EXPECT_FALSE(queue.Pop());
  EXPECT_EQ(queue.lost(), 0u);
  EXPECT_EQ(queue.waiting_bytes(), 0u);
}

TEST(FrameQueue, AFullOneLosesTheOldestDataAndNoText) {
  FrameQueue queue(300);
  queue.Push({"a text", {}, nullptr});
  for (unsigned i = 1; i <= 5; ++i) queue.Push(Data(100, i));
  EXPECT_EQ(queue.lost(), 2u);
  EXPECT_EQ(queue.Pop().value().text, "a text");
  for (unsigned i = 3; i <= 5; ++i) EXPECT_EQ(MarkOf(queue.Pop().value()), i);
}

TEST(FrameQueue, OneThatIsLargerThanAllPassesAlone) {
  FrameQueue queue(300);
  queue.Push(Data(100, 1));
  queue.Push(Data(1000, 2));
  EXPECT_EQ(queue.lost(), 1u);
  EXPECT_EQ(MarkOf(queue.Pop().value()), 2u);
}

TEST(FrameQueue, DataIsReadTogetherAsFarAsItIsTheOldestAndFits) {
  FrameQueue queue(10000);
  EXPECT_TRUE(queue.PopData(250).empty());
  for (unsigned i = 1; i <= 3; ++i) queue.Push(Data(100, i));
  queue.Push({"a text", {}, nullptr});
  queue.Push(Data(1000, 4));
  EXPECT_EQ(queue.PopData(250).size(), 2u);
  EXPECT_EQ(queue.waiting_bytes(), 1100u);
  EXPECT_EQ(MarkOf(queue.PopData(250).at(0)), 3u);
  EXPECT_TRUE(queue.PopData(250).empty()) << "a text is the oldest";
  EXPECT_EQ(queue.Pop().value().text, "a text");
  EXPECT_EQ(queue.PopData(250).size(), 1u) << "one at least";
  EXPECT_EQ(queue.waiting_bytes(), 0u);
}

TEST(FrameQueue, WhatIsLostAndWhatIsReadAreAllThatCame) {
  FrameQueue queue(1000);
  std::uint64_t read = 0;
  for (unsigned i = 0; i < 10000; ++i) {
    queue.Push(Data(sizeof(Frame) + 37 * (i % 7), i));
    EXPECT_LE(queue.waiting_bytes(), 1000u);
    if (i % 3 == 0 && queue.Pop()) ++read;
  }
  while (queue.Pop()) ++read;
  EXPECT_EQ(read + queue.lost(), 10000u);
  EXPECT_GT(queue.lost(), 0u);
  EXPECT_EQ(queue.waiting_bytes(), 0u);
}

TEST(TopicRates, AreMessagesByTimeBetweenTwoSamples) {
  TopicRates rates(2);
  rates.Sample({100, 0}, 5'000'000'000);
  EXPECT_EQ(rates.topics()[0].rate_Hz, 0.0);
  EXPECT_EQ(rates.topics()[1].news_ns, -1);
  rates.Sample({580, 0}, 7'000'000'000);
  EXPECT_DOUBLE_EQ(rates.topics()[0].rate_Hz, 240.0);
  EXPECT_EQ(rates.topics()[0].messages, 580u);
  EXPECT_EQ(rates.topics()[0].news_ns, 7'000'000'000);
  rates.Sample({580, 0}, 8'000'000'000);
  EXPECT_EQ(rates.topics()[0].rate_Hz, 0.0);
  EXPECT_EQ(rates.topics()[0].news_ns, 7'000'000'000);
  EXPECT_THROW(rates.Sample({1}, 9'000'000'000), std::invalid_argument);
}

TEST(ProcessLoad, ReadsTheTicksBehindANameThatMayHoldAnything) {
  const std::string rest = " S 1 2 3 4 5 6 7 8 9 10 1200 34 0 0 20 0";
  EXPECT_EQ(ProcessTicks("77 (sinew-view)" + rest), 1234u);
  EXPECT_EQ(ProcessTicks("77 (a) b (c) 9 9)" + rest), 1234u);
  EXPECT_EQ(ProcessTicks(""), std::nullopt);
  EXPECT_EQ(ProcessTicks("77 (a) S 1 2"), std::nullopt);
  EXPECT_EQ(ProcessTicks("77 (a) S 1 2 3 4 5 6 7 8 9 10 x 34"), std::nullopt);
  EXPECT_TRUE(ReadProcessTicks(1).has_value());
  EXPECT_FALSE(ReadProcessTicks(-1).has_value());
}

TEST(ProcessLoad, IsPercentOfACoreBetweenTwoLooks) {
  ProcessLoad load(100.0);
  EXPECT_FALSE(load.Percent(5, 1000, 0));
  EXPECT_DOUBLE_EQ(load.Percent(5, 1050, 1'000'000'000).value(), 50.0);
  EXPECT_FALSE(load.Percent(5, 10, 2'000'000'000)) << "another process has the number now";
  EXPECT_FALSE(load.Percent(5, std::nullopt, 3'000'000'000));
  EXPECT_FALSE(load.Percent(5, 1000, 4'000'000'000));
}

constexpr std::int64_t kMs = 1'000'000;

TEST(PendingAction, AnEstopIsRepeatedUntilTheRobotHasStopped) {
  PendingAction action;
  ASSERT_TRUE(action.Ask(OperatorAction::kEstop, 0));
  EXPECT_EQ(action.Due(std::nullopt, 0), OperatorAction::kEstop) << "nobody need be heard";
  EXPECT_EQ(action.Due(RobotState::kArmed, 50 * kMs), std::nullopt);
  EXPECT_EQ(action.Due(RobotState::kArmed, 100 * kMs), OperatorAction::kEstop);
  EXPECT_EQ(action.Due(RobotState::kArmed, 60'000 * kMs), OperatorAction::kEstop)
      << "never given up";
  EXPECT_FALSE(action.Ask(OperatorAction::kArm, 60'000 * kMs));
  EXPECT_EQ(action.Due(RobotState::kEstopped, 60'050 * kMs), std::nullopt);
  EXPECT_FALSE(action.pending());
  EXPECT_TRUE(action.report()->done);
  EXPECT_TRUE(action.Ask(OperatorAction::kReset, 60'100 * kMs));
}

TEST(PendingAction, AnEstopTakesThePlaceOfAnArm) {
  PendingAction action;
  ASSERT_TRUE(action.Ask(OperatorAction::kArm, 0));
  EXPECT_EQ(action.Due(RobotState::kDisarmed, 0), OperatorAction::kArm);
  ASSERT_TRUE(action.Ask(OperatorAction::kEstop, 10 * kMs));
  EXPECT_EQ(action.Due(RobotState::kDisarmed, 10 * kMs), OperatorAction::kEstop);
}

TEST(PendingAction, ArmWaitsForASessionAndIsGivenUp) {
  PendingAction action;
  ASSERT_TRUE(action.Ask(OperatorAction::kArm, 0));
  EXPECT_EQ(action.Due(std::nullopt, 0), std::nullopt);
  EXPECT_EQ(action.Due(RobotState::kFault, 10 * kMs), OperatorAction::kArm);
  EXPECT_EQ(action.Due(RobotState::kFault, 5000 * kMs), std::nullopt);
  EXPECT_FALSE(action.pending());
  EXPECT_FALSE(action.report()->done);
  EXPECT_THAT(action.report()->why, HasSubstr("'fault'"));
}

TEST(PendingAction, WhatTheRobotSaidBeforeTheFirstSendingIsNoAnswer) {
  PendingAction action;
  ASSERT_TRUE(action.Ask(OperatorAction::kDisarm, 0));
  EXPECT_EQ(action.Due(RobotState::kDisarmed, 0), OperatorAction::kDisarm);
  EXPECT_EQ(action.Due(RobotState::kDisarmed, 1 * kMs), std::nullopt);
  EXPECT_TRUE(action.report()->done);
}

const std::string kToken = "0123456789abcdef";

TEST(RequestRule, ThePageOfThisServerCommandsWithItsToken) {
  const RequestRule rule("127.0.0.1", 8765, kToken);
  for (const char* host : {"127.0.0.1:8765", "localhost:8765"}) {
    RequestHead head{host, std::string("http://") + host, kToken, true};
    EXPECT_EQ(rule.WhyNotRead(head), "");
    EXPECT_EQ(rule.WhyNotCommand(head), "");
    EXPECT_TRUE(rule.IsOfThePage(head));
    head.origin.clear();
    EXPECT_TRUE(rule.IsOfThePage(head)) << "a GET";
  }
}

TEST(RequestRule, OthersDoNot) {
  const RequestRule rule("127.0.0.1", 8765, kToken);
  const RequestHead good{"127.0.0.1:8765", "http://127.0.0.1:8765", kToken, true};
  RequestHead head = good;
  head.host = "evil.example:8765";
  EXPECT_THAT(rule.WhyNotRead(head), HasSubstr("evil.example"));
  EXPECT_NE(rule.WhyNotCommand(head), "");
  EXPECT_FALSE(rule.IsOfThePage(head));
  for (const char* origin : {"", "null", "http://evil.example", "https://127.0.0.1:8765",
                             "http://127.0.0.1:8766", "http://localhost:8765"}) {
    head = good;
    head.origin = origin;
    EXPECT_THAT(rule.WhyNotCommand(head), HasSubstr("Origin")) << origin;
    EXPECT_EQ(rule.WhyNotRead(head), "") << "viewers of other origins may read";
    EXPECT_EQ(rule.IsOfThePage(head), head.origin.empty()) << origin;
  }
  for (const std::string& token :
       {std::string(), kToken.substr(1), kToken + "x", std::string("0123456789abcdeF")}) {
    head = good;
    head.token = token;
    EXPECT_THAT(rule.WhyNotCommand(head), HasSubstr("token")) << token;
    EXPECT_FALSE(rule.IsOfThePage(head)) << token;
  }
}

TEST(RequestRule, TheTokenIsForThisHostOnly) {
  const RequestRule rule("10.0.0.5", 80, kToken);
  RequestHead head{"10.0.0.5:80", "", "", true};
  EXPECT_EQ(rule.TokenFor(head), kToken);
  head.from_loopback = false;
  EXPECT_EQ(rule.TokenFor(head), "");
  EXPECT_THROW(RequestRule("127.0.0.1", 80, "short"), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::live
