#include "components/record/logger/recorder.h"

#include <gtest/gtest.h>

#include <future>

#include "components/record/recording/mcap_reader.h"
#include "tests/components/record/logger/messages.h"
#include "tests/support/memory_io.h"

namespace sinew::logger {
namespace {

using recording::Bytes;
using recording::IoStatus;
using testing::MakeMessage;
using testing::SchemaOf;

// A sink that can be read while it is written, can be held, and can be full.
class TestSink : public RecordingSink {
 public:
  explicit TestSink(std::size_t capacity = ~std::size_t{0}) : capacity_(capacity) {}
  IoStatus Write(std::span<const std::byte> bytes) override {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [this] { return !held_; });
    if (bytes.size() > capacity_ - bytes_.size())
      return IoStatus::Failed("No space left on device");
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    changed_.notify_all();
    return IoStatus::Ok();
  }
  IoStatus Begin(int) override { return IoStatus::Ok(); }
  IoStatus Sync() override { return IoStatus::Ok(); }
  IoStatus End() override { return IoStatus::Ok(); }
  void Hold(bool held) {
    const std::lock_guard<std::mutex> lock(mutex_);
    held_ = held;
    changed_.notify_all();
  }
  Bytes bytes() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return bytes_;
  }
  // True when `count` messages can be read from what was written, within the limit.
  bool WaitForMessages(std::uint64_t count, std::chrono::milliseconds limit) {
    const auto end = std::chrono::steady_clock::now() + limit;
    std::unique_lock<std::mutex> lock(mutex_);
    while (Messages(bytes_) < count) {
      if (changed_.wait_until(lock, end) == std::cv_status::timeout)
        return Messages(bytes_) >= count;
    }
    return true;
  }

 private:
  static std::uint64_t Messages(const Bytes& bytes) {
    recording::MemorySource source(bytes);
    try {
      return recording::McapReader(source).statistics().message_count;
    } catch (const recording::McapError&) {
      return 0;  // not even the header yet
    }
  }
  const std::size_t capacity_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  Bytes bytes_;
  bool held_ = false;
};

Bytes JointState(int tick, bool last = false) {
  return MakeMessage("joint_state", {{"header.session_id", 5},
                                     {"header.tick", tick},
                                     {"header.stamp_ns", 1000.0 * tick},
                                     {"position_rad[0]", 0.25 * tick},
                                     {"last_tick", last ? 1 : 0}});
}

TEST(Recorder, WritesEveryOfferedMessageWithItsStamps) {
  TestSink sink;
  Recorder recorder(sink, {SchemaOf("joint_state"), SchemaOf("reference")},
                    {{"sinew.recording", {{"seed", "3"}}}});
  for (int tick = 0; tick < 500; ++tick) {
    ASSERT_TRUE(recorder.Offer(0, JointState(tick, tick == 499), 7'000'000 + tick));
  }
  ASSERT_TRUE(recorder.Finish().ok());
  const Bytes bytes = sink.bytes();
  recording::MemorySource source(bytes);
  const recording::McapReader reader(source);
  EXPECT_FALSE(reader.recovery().has_value());
  EXPECT_EQ(reader.channels().size(), 1u);  // topics without messages have no channel
  EXPECT_EQ(reader.schemas().size(), 2u);   // but their types are there
  EXPECT_EQ(reader.ReadMetadata().at(0).values.at("seed"), "3");
  recording::McapMessages messages = reader.Messages();
  recording::McapMessage message;
  for (int tick = 0; tick < 500; ++tick) {
    ASSERT_TRUE(messages.Next(&message));
    EXPECT_EQ(message.log_time_ns, 7'000'000 + tick);
    EXPECT_EQ(message.publish_time_ns, 1000 * tick);
    EXPECT_EQ(Bytes(message.data.begin(), message.data.end()), JointState(tick, tick == 499));
  }
  const RecorderState state = recorder.state();
  EXPECT_EQ(state.messages, 500u);
  EXPECT_EQ(state.losses.dropped, 0u);
  ASSERT_TRUE(state.session.has_value());
  EXPECT_EQ(state.session->session_id, 5u);
  EXPECT_EQ(state.session->tick, 499u);
  EXPECT_TRUE(state.session->last_tick);
  EXPECT_FALSE(recorder.Offer(0, JointState(500), 0));
  EXPECT_FALSE(recorder.Finish().ok());
}

TEST(Recorder, MakesEqualMessagesEqualBytes) {
  TestSink sink;
  Recorder recorder(sink, {SchemaOf("joint_state")}, {});
  Bytes noisy = JointState(1);
  noisy[4 + 57] = std::byte{0x77};  // alignment before period_s
  noisy.resize(noisy.size() + 2, std::byte{9});
  ASSERT_TRUE(recorder.Offer(0, noisy, 1));
  ASSERT_TRUE(recorder.Finish().ok());
  const Bytes bytes = sink.bytes();
  recording::MemorySource source(bytes);
  const recording::McapReader reader(source);
  recording::McapMessages messages = reader.Messages();
  recording::McapMessage message;
  ASSERT_TRUE(messages.Next(&message));
  EXPECT_EQ(Bytes(message.data.begin(), message.data.end()), JointState(1));
}

TEST(Recorder, HandsAMessageToTheFileWithin200MillisecondsOfSilence) {
  TestSink sink;
  Recorder recorder(sink, {SchemaOf("joint_state")}, {});
  ASSERT_TRUE(recorder.Offer(0, JointState(0), 0));
  // Without Finish: what a killed recorder leaves. The limit is for a loaded machine; 100 ms are
  // meant.
  EXPECT_TRUE(sink.WaitForMessages(1, std::chrono::seconds(5)));
}

TEST(Recorder, CountsWhatDoesNotFitTheQueue) {
  TestSink sink;
  sink.Hold(true);  // a disk that stands still
  const std::size_t size = JointState(0).size();
  Recorder recorder(sink, {SchemaOf("joint_state")}, {}, {.queue_bytes = 10 * size});
  int taken = 0;
  for (int tick = 0; tick < 100; ++tick) taken += recorder.Offer(0, JointState(tick), tick) ? 1 : 0;
  EXPECT_EQ(taken, 10);
  EXPECT_EQ(recorder.state().losses.dropped, 90u);
  EXPECT_EQ(recorder.state().topics[0].losses.dropped, 90u);
  sink.Hold(false);
  ASSERT_TRUE(recorder.Finish().ok());
  EXPECT_EQ(recorder.state().messages, 10u);
}

TEST(Recorder, WaitsForCapacityWhenNothingMayBeDropped) {
  TestSink sink;
  sink.Hold(true);
  const std::size_t size = JointState(0).size();
  Recorder recorder(sink, {SchemaOf("joint_state")}, {},
                    {.queue_bytes = 10 * size, .wait_for_capacity = true});
  std::atomic<int> taken{0};
  auto sender = std::async(std::launch::async, [&] {
    for (int tick = 0; tick < 100; ++tick)
      taken += recorder.Offer(0, JointState(tick), tick) ? 1 : 0;
  });
  while (taken < 10) std::this_thread::yield();
  sink.Hold(false);
  sender.wait();
  EXPECT_EQ(taken, 100);
  ASSERT_TRUE(recorder.Finish().ok());
  EXPECT_EQ(recorder.state().messages, 100u);
  EXPECT_EQ(recorder.state().losses.dropped, 0u);
}

TEST(Recorder, ReportsAFullDiskAndTakesNothingMore) {
  TestSink sink(3000);
  Recorder recorder(sink, {SchemaOf("joint_state")}, {}, {.wait_for_capacity = true});
  std::int64_t time = 0;
  while (recorder.Offer(0, JointState(0), time)) time += 50'000'000;
  EXPECT_EQ(recorder.state().status.message(), "No space left on device");
  EXPECT_EQ(recorder.Finish().message(), "No space left on device");
}

TEST(Recorder, ReadsOnAfterAFullDiskWhereAProviderWaitsForIt) {
  TestSink sink(3000);
  Recorder recorder(sink, {SchemaOf("joint_state")}, {},
                    {.wait_for_capacity = true, .read_on_after_error = true});
  for (int tick = 0; tick < 500; ++tick) {
    ASSERT_TRUE(recorder.Offer(0, JointState(tick), 50'000'000LL * tick));
  }
  EXPECT_EQ(recorder.Finish().message(), "No space left on device");
  const RecorderState state = recorder.state();
  ASSERT_TRUE(state.session.has_value());
  EXPECT_EQ(state.session->tick, 499u);
  EXPECT_LT(state.written, 500u);
}

TEST(Recorder, KeepsMessagesThatDoNotFitTheirType) {
  TestSink sink;
  Recorder recorder(sink, {SchemaOf("joint_state")}, {});
  const Bytes odd = {std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}, std::byte{42}};
  ASSERT_TRUE(recorder.Offer(0, odd, 3));
  ASSERT_TRUE(recorder.Finish().ok());
  EXPECT_EQ(recorder.state().losses.malformed, 1u);
  EXPECT_EQ(recorder.state().messages, 1u);
  EXPECT_FALSE(recorder.state().session.has_value());
}

TEST(Recorder, CountsTicksThatNeverCame) {
  TestSink sink;
  Recorder recorder(sink, {SchemaOf("joint_state")}, {});
  for (const int tick : {10, 11, 14, 15}) ASSERT_TRUE(recorder.Offer(0, JointState(tick), tick));
  ASSERT_TRUE(recorder.Finish().ok());
  EXPECT_EQ(recorder.state().missing_ticks, 2u);
}

TEST(Recorder, EndsWithoutFinish) {
  TestSink sink;
  {
    Recorder recorder(sink, {SchemaOf("joint_state")}, {});
    for (int tick = 0; tick < 1000; ++tick) ASSERT_TRUE(recorder.Offer(0, JointState(tick), tick));
  }
  const Bytes bytes = sink.bytes();
  recording::MemorySource source(bytes);
  EXPECT_TRUE(recording::McapReader(source).recovery().has_value());
}

TEST(Recorder, RefusesASchemaItCannotRead) {
  TestSink sink;
  recording::TopicSchema schema = SchemaOf("joint_state");
  schema.idl = "struct { };";
  EXPECT_THROW(Recorder(sink, {schema}, {}), recording::IdlError);
}

}  // namespace
}  // namespace sinew::logger
