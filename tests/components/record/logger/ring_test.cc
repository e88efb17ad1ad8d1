// A recorder that writes only what surrounds a fault, and what it knows of losses.
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "components/record/logger/recorder.h"
#include "tests/components/record/logger/memory_series.h"
#include "tests/components/record/logger/messages.h"
#include "tests/support/memory_io.h"

namespace sinew::logger {
namespace {

using namespace std::chrono_literals;
using recording::Bytes;
using recording::McapReader;
using testing::MakeMessage;
using testing::MemorySeries;
using testing::SchemaOf;

constexpr double kArmed = 1.0, kFault = 3.0, kComponentActive = 1.0, kComponentFault = 2.0;

Bytes RobotAt(int tick, double robot_state) {
  return MakeMessage(
      "joint_state",
      {{"header.session_id", 5}, {"header.tick", tick}, {"robot_state", robot_state}});
}

std::vector<recording::TopicSchema> RingTopics() {
  return {SchemaOf("joint_state"), SchemaOf("component_status")};
}

RecorderOptions RingOf(std::chrono::milliseconds last, std::chrono::milliseconds after) {
  RecorderOptions options;
  options.wait_for_capacity = true;
  options.ring.last = last;
  options.ring.after = after;
  options.ring.on_fault = true;
  return options;
}

// Ticks of joint_state in a file, and why it was written.
struct Dump {
  std::vector<std::uint64_t> ticks;
  std::string reason;
};

Dump ReadDump(const Bytes& bytes) {
  recording::MemorySource source(bytes);
  const McapReader reader(source);
  EXPECT_FALSE(reader.recovery().has_value());
  Dump dump;
  for (const recording::McapMetadata& metadata : reader.ReadMetadata()) {
    if (metadata.name == "sinew.trigger") dump.reason = metadata.values.at("reason");
  }
  recording::McapMessages messages = reader.Messages();
  recording::McapMessage message;
  while (messages.Next(&message)) {
    if (reader.channels().at(message.channel_id).topic != "joint_state") continue;
    dump.ticks.push_back(
        static_cast<std::uint64_t>(testing::FieldOf("joint_state", message.data, "header.tick")));
  }
  return dump;
}

std::vector<std::uint64_t> TicksFromTo(std::uint64_t from, std::uint64_t to) {
  std::vector<std::uint64_t> ticks;
  for (std::uint64_t tick = from; tick <= to; ++tick) ticks.push_back(tick);
  return ticks;
}

// Waits until the recorder's state is so; bounded.
template <class Condition>
bool Becomes(const Recorder& recorder, Condition condition) {
  const auto give_up = std::chrono::steady_clock::now() + 20s;
  while (!condition(recorder.state())) {
    if (std::chrono::steady_clock::now() > give_up) return false;
    std::this_thread::yield();
  }
  return true;
}

TEST(Ring, WritesWhatSurroundsAFaultOfTheRobot) {
  MemorySeries sink;
  Recorder recorder(sink, RingTopics(), {}, RingOf(1s, 1h));
  for (int tick = 0; tick < 1000; ++tick) {  // 10 s, a fault at 5 s
    const double state = tick < 500 ? kArmed : kFault;
    ASSERT_TRUE(recorder.Offer(0, RobotAt(tick, state), 10'000'000LL * tick));
  }
  ASSERT_TRUE(recorder.Finish().ok());
  ASSERT_EQ(sink.files().size(), 1u);
  const Dump dump = ReadDump(sink.files()[0]);
  EXPECT_EQ(dump.ticks, TicksFromTo(400, 999));
  EXPECT_EQ(dump.reason, "joint_state: ROBOT_FAULT");
  EXPECT_EQ(recorder.state().triggers, 1) << "it stays in fault: that is one trigger";
  EXPECT_EQ(recorder.state().written, 600u);
  EXPECT_EQ(recorder.state().messages, 1000u);
}

TEST(Ring, WritesNothingWithoutAFault) {
  MemorySeries sink;
  Recorder recorder(sink, RingTopics(), {}, RingOf(1s, 1h));
  for (int tick = 0; tick < 1000; ++tick) {
    ASSERT_TRUE(recorder.Offer(0, RobotAt(tick, kArmed), 10'000'000LL * tick));
  }
  ASSERT_TRUE(recorder.Finish().ok());
  EXPECT_TRUE(sink.files().empty());
}

TEST(Ring, EachFaultAfterTheEndOfAFileBeginsAnother) {
  MemorySeries sink;
  Recorder recorder(sink, RingTopics(), {}, RingOf(1h, 0ms));
  const WriterGuid writer = {7};
  const auto status = [&](double state, std::int64_t time_ns) {
    return recorder.Offer(1, MakeMessage("component_status", {{"state", state}}), time_ns,
                          {writer, 0});
  };
  ASSERT_TRUE(recorder.Offer(0, RobotAt(1, kArmed), 1));
  ASSERT_TRUE(status(kComponentFault, 2));
  ASSERT_TRUE(Becomes(recorder, [&](const RecorderState&) { return sink.ended() == 1; }));
  ASSERT_TRUE(recorder.Offer(0, RobotAt(2, kArmed), 3));
  ASSERT_TRUE(status(kComponentFault, 4));  // still
  ASSERT_TRUE(status(kComponentActive, 5));
  ASSERT_TRUE(Becomes(recorder, [](const RecorderState& now) { return now.messages == 5; }));
  EXPECT_EQ(sink.files().size(), 1u);
  ASSERT_TRUE(status(kComponentFault, 6));
  ASSERT_TRUE(Becomes(recorder, [&](const RecorderState&) { return sink.ended() == 2; }));
  ASSERT_TRUE(recorder.Finish().ok());
  ASSERT_EQ(sink.files().size(), 2u);
  EXPECT_EQ(ReadDump(sink.files()[0]).ticks, TicksFromTo(1, 1));
  EXPECT_EQ(ReadDump(sink.files()[1]).ticks, TicksFromTo(2, 2)) << "nothing is lost between";
  EXPECT_EQ(ReadDump(sink.files()[1]).reason, "component_status: '' is in fault: ");
}

TEST(Ring, WritesOnRequest) {
  MemorySeries sink;
  RecorderOptions options = RingOf(1h, 1h);
  options.ring.on_fault = false;
  Recorder recorder(sink, RingTopics(), {}, options);
  ASSERT_TRUE(recorder.Offer(0, RobotAt(1, kFault), 1));
  ASSERT_TRUE(Becomes(recorder, [](const RecorderState& now) { return now.messages == 1; }));
  EXPECT_TRUE(sink.files().empty()) << "faults were not asked for";
  recorder.Trigger("SIGUSR1");
  ASSERT_TRUE(Becomes(recorder, [](const RecorderState& now) { return now.triggers == 1; }));
  ASSERT_TRUE(recorder.Offer(0, RobotAt(2, kFault), 2));
  ASSERT_TRUE(recorder.Finish().ok());
  const Dump dump = ReadDump(sink.files().at(0));
  EXPECT_EQ(dump.ticks, TicksFromTo(1, 2));
  EXPECT_EQ(dump.reason, "SIGUSR1");
}

TEST(Losses, GapsInTheNumbersOfAWriterAreCountedByTopic) {
  MemorySeries sink;
  Recorder recorder(sink, RingTopics(), {}, {.wait_for_capacity = true});
  const WriterGuid one = {1}, other = {2};
  for (const std::uint64_t sequence : {40, 41, 44, 45}) {  // it was there before: no loss
    ASSERT_TRUE(recorder.Offer(0, RobotAt(1, kArmed), 1, {one, sequence}));
    ASSERT_TRUE(recorder.Offer(0, RobotAt(1, kArmed), 1, {other, sequence / 40}));
    ASSERT_TRUE(recorder.Offer(0, RobotAt(1, kArmed), 1, {one, 0}));  // not known
  }
  recorder.SetLost(1, 9);
  ASSERT_TRUE(recorder.Finish().ok());
  const RecorderState state = recorder.state();
  EXPECT_EQ(state.topics[0].losses.missing, 2u);
  EXPECT_EQ(state.losses.missing, 2u);
  EXPECT_EQ(state.losses.lost, 9u);
  const std::vector<Bytes> files = sink.files();
  recording::MemorySource source(files.at(0));
  const recording::TextMap values = McapReader(source).ReadMetadata().back().values;
  EXPECT_EQ(values.at("joint_state.missing"), "2");
  EXPECT_EQ(values.at("component_status.lost"), "9");
}

}  // namespace
}  // namespace sinew::logger
