#include "components/topics/node/sample_queue.h"

#include <gtest/gtest.h>

namespace sinew::node::internal {
namespace {

Sample SampleOf(int value) {
  Sample sample;
  sample.bytes.assign(3, static_cast<std::byte>(value));
  sample.source_stamp_ns = value;
  return sample;
}

void Push(SampleQueue* queue, int value) {
  Sample sample = SampleOf(value);
  queue->Push(&sample);
}

TEST(SampleQueue, GivesSamplesInTheOrderOfTheirArrival) {
  SampleQueue queue(1000);
  EXPECT_TRUE(queue.empty());
  EXPECT_FALSE(queue.TakeNext().has_value());
  for (int value = 0; value < 100; ++value) Push(&queue, value);
  for (int value = 0; value < 100; ++value) {
    const auto sample = queue.TakeNext();
    ASSERT_TRUE(sample.has_value());
    EXPECT_EQ(sample->source_stamp_ns, value);
    EXPECT_EQ(sample->bytes, SampleOf(value).bytes);
  }
  EXPECT_TRUE(queue.empty());
}

TEST(SampleQueue, GivesTheNewestAndDiscardsTheOthers) {
  SampleQueue queue(1000);
  EXPECT_FALSE(queue.TakeLatest().has_value());
  for (int value = 0; value < 3; ++value) Push(&queue, value);
  EXPECT_EQ(queue.TakeLatest()->source_stamp_ns, 2);
  EXPECT_TRUE(queue.empty());
}

TEST(SampleQueue, DropsTheOldestWhenFullAndCountsIt) {
  SampleQueue queue(2);
  for (int value = 0; value < 5; ++value) {
    Sample sample = SampleOf(value);
    EXPECT_EQ(queue.Push(&sample), value < 2);
  }
  EXPECT_EQ(queue.dropped(), 3u);
  EXPECT_EQ(queue.TakeNext()->source_stamp_ns, 3);
  EXPECT_EQ(queue.TakeNext()->source_stamp_ns, 4);
  EXPECT_FALSE(queue.TakeNext().has_value());
}

TEST(SampleQueue, HandsTheBufferOfADroppedSampleBack) {
  SampleQueue queue(1);
  Sample sample = SampleOf(1);
  EXPECT_TRUE(queue.Push(&sample));
  EXPECT_EQ(sample.bytes.capacity(), 0u);
  sample = SampleOf(2);
  EXPECT_FALSE(queue.Push(&sample));
  EXPECT_GE(sample.bytes.capacity(), 3u);
}

TEST(SampleQueue, IsLongerWhereASampleIsALoss) {
  EXPECT_EQ(QueueLimit(Profile::kState, TimeMode::kRealtime), 8u);
  EXPECT_EQ(QueueLimit(Profile::kControl, TimeMode::kRealtime), 8u);
  EXPECT_EQ(QueueLimit(Profile::kEvent, TimeMode::kRealtime), 256u);
  EXPECT_EQ(QueueLimit(Profile::kLatched, TimeMode::kRealtime), 256u);
  for (const Profile profile : {Profile::kState, Profile::kEvent}) {
    EXPECT_EQ(QueueLimit(profile, TimeMode::kLockstep), 65536u);
  }
}

}  // namespace
}  // namespace sinew::node::internal
