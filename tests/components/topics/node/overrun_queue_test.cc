#include "components/topics/node/overrun_queue.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

namespace sinew::node::internal {
namespace {

TEST(OverrunQueue, GivesEntriesInTheirOrder) {
  OverrunQueue<int> queue(100);
  for (int value = 0; value < 100; ++value) queue.Push(value);
  for (int value = 0; value < 100; ++value) EXPECT_EQ(queue.Take(), value);
  EXPECT_EQ(queue.pushed(), 100u);
  EXPECT_EQ(queue.dropped(), 0u);
}

TEST(OverrunQueue, AFullOneDropsItsOldestEntriesAndCountsThem) {
  OverrunQueue<int> queue(3);
  for (int value = 0; value < 10; ++value) queue.Push(value);
  EXPECT_EQ(queue.dropped(), 7u);
  for (int value = 7; value < 10; ++value) EXPECT_EQ(queue.Take(), value);
  queue.Push(10);
  EXPECT_EQ(queue.Take(), 10) << "what was dropped left no wake-up that finds nothing";
}

TEST(OverrunQueue, TryTakeGivesNothingWhereNothingIs) {
  OverrunQueue<int> queue(3);
  EXPECT_FALSE(queue.TryTake().has_value());
  queue.Push(1);
  EXPECT_EQ(queue.TryTake(), 1);
  EXPECT_FALSE(queue.TryTake().has_value());
}

TEST(OverrunQueue, TakesWhatManyThreadsPush) {
  constexpr int kThreads = 4, kEach = 2000;
  OverrunQueue<int> queue(kThreads * kEach);
  std::vector<std::thread> threads;
  for (int thread = 0; thread < kThreads; ++thread) {
    threads.emplace_back([&queue] {
      for (int value = 1; value <= kEach; ++value) queue.Push(value);
    });
  }
  long sum = 0;
  for (int count = 0; count < kThreads * kEach; ++count) sum += queue.Take();
  EXPECT_EQ(sum, static_cast<long>(kThreads) * kEach * (kEach + 1) / 2);
  for (std::thread& thread : threads) thread.join();
}

TEST(WakeUp, WhatWasGivenBeforeTheWaitIsNotLostAndNothingIsGivenTwice) {
  WakeUp wake_up;
  wake_up.Give();
  const auto soon = std::chrono::steady_clock::now() + std::chrono::milliseconds(1);
  EXPECT_TRUE(wake_up.WaitUntil(soon));
  EXPECT_FALSE(wake_up.WaitUntil(soon));
  EXPECT_GE(std::chrono::steady_clock::now(), soon);
}

}  // namespace
}  // namespace sinew::node::internal
