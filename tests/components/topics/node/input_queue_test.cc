#include "components/topics/node/input_queue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace sinew::node::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr std::uint64_t kSession = 9;

// A queue whose samples carry their tick as their only byte; keeps the ticks that were decoded.
struct Input {
  explicit Input(InputRules rules = {}, std::size_t limit = 100) : queue(rules, limit) {}

  void Push(std::uint64_t tick) {
    queue.Push({kSession, tick}, Bytes{static_cast<std::byte>(tick)});
  }
  void Accept(std::uint64_t tick, bool lockstep) { queue.Accept(tick, lockstep, decode); }

  InputQueue queue;
  std::vector<int> decoded;
  InputQueue::Decode decode = [this](const Bytes& bytes) {
    decoded.push_back(std::to_integer<int>(bytes.at(0)));
    return true;
  };
};

TEST(InputQueue, IsNeverFreshWithoutSamples) {
  for (const bool lockstep : {false, true}) {
    Input input;
    EXPECT_FALSE(input.queue.Reached(0));
    input.Accept(0, lockstep);
    EXPECT_FALSE(input.queue.accepted());
    EXPECT_FALSE(input.queue.fresh());
    EXPECT_FALSE(input.queue.front().has_value());
  }
}

TEST(InputQueue, GivesInLockstepTheSampleOfTheTickAndKeepsLaterOnes) {
  Input input;
  for (const std::uint64_t tick : {3u, 4u, 5u}) input.Push(tick);
  EXPECT_TRUE(input.queue.Reached(4));
  input.Accept(4, true);
  EXPECT_THAT(input.decoded, ElementsAre(3, 4));
  EXPECT_EQ(input.queue.accepted_tick(), 4u);
  EXPECT_TRUE(input.queue.fresh());
  EXPECT_EQ(input.queue.front()->tick, 5u);
}

TEST(InputQueue, GivesInRealTimeTheNewestSample) {
  Input input;
  for (const std::uint64_t tick : {3u, 4u, 5u}) input.Push(tick);
  input.Accept(4, false);
  EXPECT_EQ(input.queue.accepted_tick(), 5u);
  EXPECT_TRUE(input.queue.fresh());
  input.Accept(6, false);
  EXPECT_EQ(input.queue.accepted_tick(), 5u) << "the last value stays";
  EXPECT_FALSE(input.queue.fresh()) << "but it is not of tick 6";
}

TEST(InputQueue, GivesTheNewestSampleInLockstepWhenItIsNotRequired) {
  Input input({.required = false});
  for (const std::uint64_t tick : {3u, 8u}) input.Push(tick);
  input.Accept(4, true);
  EXPECT_EQ(input.queue.accepted_tick(), 8u);
}

TEST(InputQueue, LooksForTheTickBeforeTheDelay) {
  Input input({.delay_ticks = 2});
  EXPECT_TRUE(input.queue.Reached(1)) << "nothing is to come before the delay";
  EXPECT_FALSE(input.queue.Reached(2));
  for (const std::uint64_t tick : {0u, 1u}) input.Push(tick);
  input.Accept(1, true);
  EXPECT_THAT(input.decoded, IsEmpty());
  EXPECT_FALSE(input.queue.fresh());
  EXPECT_TRUE(input.queue.Reached(2));
  input.Accept(2, true);
  EXPECT_EQ(input.queue.accepted_tick(), 0u);
  EXPECT_TRUE(input.queue.fresh());
}

TEST(InputQueue, SkipsSamplesThatCannotBeDecoded) {
  Input input;
  input.Push(3);
  input.queue.Accept(3, true, [](const Bytes&) { return false; });
  EXPECT_FALSE(input.queue.accepted());
  EXPECT_FALSE(input.queue.fresh());
  EXPECT_FALSE(input.queue.front().has_value()) << "the sample is gone";
}

TEST(InputQueue, OfATriggerGivesExactlyItsOldestSample) {
  Input input;
  for (const std::uint64_t tick : {3u, 4u}) input.Push(tick);
  EXPECT_TRUE(input.queue.AcceptFront(input.decode));
  EXPECT_THAT(input.decoded, ElementsAre(3));
  EXPECT_TRUE(input.queue.fresh());
  EXPECT_EQ(input.queue.front()->tick, 4u);
  input.Push(5);
  input.queue.DropAllButNewest();
  EXPECT_EQ(input.queue.front()->tick, 5u);
}

TEST(InputQueue, OfATriggerSaysWhenItsOldestSampleWasMalformed) {
  Input input;
  for (const std::uint64_t tick : {3u, 4u}) input.Push(tick);
  EXPECT_FALSE(input.queue.AcceptFront([](const Bytes&) { return false; }));
  EXPECT_FALSE(input.queue.fresh());
  EXPECT_EQ(input.queue.front()->tick, 4u) << "it is gone";
}

TEST(InputQueue, DropsItsOldestSampleWhenFullAndCountsIt) {
  Input input({}, 3);
  for (std::uint64_t tick = 0; tick < 3; ++tick) input.Push(tick);
  EXPECT_EQ(input.queue.dropped(), 0u);
  for (std::uint64_t tick = 3; tick < 10; ++tick) input.Push(tick);
  EXPECT_EQ(input.queue.dropped(), 7u);
  EXPECT_EQ(input.queue.front()->tick, 7u);
  input.Accept(6, true);
  EXPECT_FALSE(input.queue.fresh()) << "the sample of tick 6 was dropped";
  input.queue.DropAllButNewest();
  EXPECT_EQ(input.queue.dropped(), 9u);
  EXPECT_EQ(input.queue.front()->tick, 9u);
}

TEST(InputQueue, ForgetsEverythingWithANewSession) {
  Input input;
  input.Push(3);
  input.Accept(3, true);
  input.Push(4);
  input.queue.Reset();
  EXPECT_FALSE(input.queue.accepted());
  EXPECT_FALSE(input.queue.fresh());
  EXPECT_FALSE(input.queue.Reached(3));
}

TEST(InputQueue, SaysInTheCycleOfTheFirstSampleOfAnotherWriterThatTheWriterHasChanged) {
  Input input;
  const auto push = [&](std::uint64_t tick, std::uint8_t writer) {
    input.queue.Push({kSession, tick}, Bytes{static_cast<std::byte>(tick)}, {writer});
    input.Accept(tick, false);
  };
  push(0, 1);
  EXPECT_FALSE(input.queue.writer_changed()) << "there was none before";
  push(1, 1);
  EXPECT_FALSE(input.queue.writer_changed());
  push(2, 2);
  EXPECT_TRUE(input.queue.writer_changed());
  input.Accept(3, false);
  EXPECT_FALSE(input.queue.writer_changed()) << "nothing came";
  push(4, 2);
  EXPECT_FALSE(input.queue.writer_changed());
  input.queue.Reset();
  push(5, 1);
  EXPECT_FALSE(input.queue.writer_changed()) << "a new session";
}

}  // namespace
}  // namespace sinew::node::internal
