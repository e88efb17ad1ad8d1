// What numbered files and the files of a ring repeat of what came before them.
#include "components/record/logger/latched_samples.h"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cstring>
#include <functional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "components/record/logger/recorder.h"
#include "components/record/recording/mcap_recover.h"
#include "tests/components/record/logger/memory_series.h"
#include "tests/components/record/logger/messages.h"
#include "tests/support/memory_io.h"

namespace sinew::logger {
namespace {

using recording::Bytes;
using testing::MakeMessage;
using testing::SchemaOf;

constexpr std::size_t kState = 0, kStatus = 1, kCommand = 2;  // topics
constexpr WriterGuid kAnn = {1}, kBen = {2}, kProvider = {9};

std::vector<recording::TopicSchema> LatchedTopics() {
  return {SchemaOf("joint_state"), SchemaOf("component_status"), SchemaOf("operator_command")};
}

const std::vector<Repeats> kRepeats = {Repeats::kNothing, Repeats::kOfLiveWriters,
                                       Repeats::kOfTheSession};

RecordedMessage Sample(std::size_t topic, const WriterGuid& writer, std::uint64_t sequence,
                       std::uint64_t session_id = 5, std::uint64_t instance = 0) {
  RecordedMessage message;
  message.topic = topic;
  message.origin = {writer, sequence};
  message.session_id = session_id;
  message.instance = instance;
  return message;
}

// Topic, first byte of the writer, sequence number.
using Facts = std::vector<std::array<std::uint64_t, 3>>;

Facts NowOf(const LatchedSamples& samples,
            const std::function<bool(const WriterGuid&)>& is_live = {}) {
  Facts facts;
  for (const LatchedSample* sample : samples.Now(is_live)) {
    const RecordedMessage& message = sample->message;
    facts.push_back({message.topic, message.origin.writer[0], message.origin.sequence});
  }
  return facts;
}

TEST(LatchedSamples, AreTheNewestOfEachWriterAndInstanceInTheOrderOfReception) {
  LatchedSamples samples(kRepeats);
  EXPECT_TRUE(NowOf(samples).empty());
  samples.Keep(Sample(kState, kProvider, 1), {});
  samples.Keep(Sample(kStatus, kAnn, 1), {});
  samples.Keep(Sample(kStatus, kBen, 7, 5, 1), {});
  samples.Keep(Sample(kStatus, kBen, 8, 5, 2), {});
  samples.Keep(Sample(kStatus, kBen, 9, 5, 1), {});
  samples.Keep(Sample(kStatus, kAnn, 2), {});
  EXPECT_EQ(NowOf(samples), (Facts{{kStatus, 2, 8}, {kStatus, 2, 9}, {kStatus, 1, 2}}));
}

TEST(LatchedSamples, OfStatusAreThoseOfWritersThatAreThere) {
  LatchedSamples samples(kRepeats);
  samples.Keep(Sample(kStatus, kAnn, 1), {});
  samples.Keep(Sample(kStatus, kBen, 1), {});
  samples.Keep(Sample(kCommand, kBen, 1), {});
  const auto ann_is_live = [](const WriterGuid& writer) { return writer == kAnn; };
  EXPECT_EQ(NowOf(samples, ann_is_live), (Facts{{kStatus, 1, 1}, {kCommand, 2, 1}}))
      << "a command is in force when its writer has gone";
}

TEST(LatchedSamples, OfRequestsAreThoseOfTheSession) {
  LatchedSamples samples(kRepeats);
  samples.Keep(Sample(kCommand, kAnn, 1, 5), {});
  EXPECT_EQ(NowOf(samples).size(), 1u) << "no session is known";
  samples.Keep(Sample(kState, kProvider, 1, 5), {});
  samples.Keep(Sample(kStatus, kBen, 1, 0), {});  // status of no session
  EXPECT_EQ(NowOf(samples).size(), 2u);
  samples.Keep(Sample(kState, kProvider, 2, 6), {});
  EXPECT_EQ(NowOf(samples), (Facts{{kStatus, 2, 1}}));
}

TEST(LatchedSamples, LinesOfALogSayNothingOfTheSession) {
  LatchedSamples samples({Repeats::kNothing, Repeats::kNoSession, Repeats::kOfTheSession});
  samples.Keep(Sample(kCommand, kAnn, 1, 6), {});
  samples.Keep(Sample(kState, kProvider, 1, 6), {});
  samples.Keep(Sample(kStatus, kBen, 1, 5), {});
  EXPECT_EQ(NowOf(samples), (Facts{{kCommand, 1, 1}}));
}

TEST(LatchedSamples, AreBoundedInNumber) {
  LatchedSamples samples(kRepeats);
  for (std::uint64_t i = 0; i < LatchedSamples::kMost + 10; ++i) {
    samples.Keep(Sample(kStatus, kAnn, i + 1, 5, i), {});
  }
  EXPECT_EQ(samples.size(), LatchedSamples::kMost);
  EXPECT_EQ(NowOf(samples).front()[2], 11u) << "the oldest have gone";
}

TEST(LatchedSamples, AreNotThoseThatDoNotFitTheirType) {
  LatchedSamples samples(kRepeats);
  RecordedMessage broken = Sample(kStatus, kAnn, 1);
  broken.malformed = true;
  samples.Keep(broken, {});
  EXPECT_EQ(samples.size(), 0u);
}

// A message of a file.
struct InFile {
  std::string topic, writer_guid, participant;
  std::uint32_t sequence = 0;
  std::int64_t log_time_ns = 0, publish_time_ns = 0;

  bool operator==(const InFile&) const = default;
};

std::vector<InFile> MessagesIn(const Bytes& file, std::string* repeated) {
  recording::MemorySource source(file);
  const recording::McapReader reader(source);
  *repeated = "none";
  for (const recording::McapMetadata& metadata : reader.ReadMetadata()) {
    if (metadata.name == "sinew.repeated") *repeated = metadata.values.at("messages");
  }
  std::vector<InFile> out;
  recording::McapMessages messages = reader.Messages();
  recording::McapMessage message;
  while (messages.Next(&message)) {
    const recording::McapChannel& channel = reader.channels().at(message.channel_id);
    out.push_back({channel.topic, channel.metadata.at("writer_guid"),
                   channel.metadata.at("participant"), message.sequence, message.log_time_ns,
                   message.publish_time_ns});
  }
  return out;
}

FilesOptions RepeatingOptions() {
  FilesOptions options;
  options.repeats = kRepeats;
  options.describe_writer = [](const WriterGuid& writer) {
    return recording::TextMap{{"participant", "writer " + std::to_string(writer[0])}};
  };
  return options;
}

// The name is of up to three characters: it stays within the padding of an empty one.
Bytes StatusOf(const std::string& name, std::int64_t stamp_ns) {
  Bytes bytes = MakeMessage("component_status",
                            {{"header.stamp_ns", static_cast<double>(stamp_ns)}, {"state", 1}});
  bytes[4] = static_cast<std::byte>(name.size() + 1);
  std::memcpy(bytes.data() + 8, name.data(), name.size());
  return bytes;
}

Bytes StateAt(int tick) {
  return MakeMessage(
      "joint_state",
      {{"header.session_id", 5}, {"header.tick", tick}, {"header.stamp_ns", 1e7 * tick}});
}

Bytes CommandAt(int tick) {
  return MakeMessage("operator_command", {{"header.session_id", 5}, {"header.tick", tick}});
}

constexpr std::int64_t kPeriod_ns = 10'000'000;

// 4 s: a state every 10 ms; status of two components by one writer, and a command, once at the
// start.
void OfferFourSeconds(Recorder* recorder) {
  std::uint64_t sequence = 0;
  for (int tick = 0; tick < 400; ++tick) {
    const std::int64_t now_ns = kPeriod_ns * (tick + 1);
    ASSERT_TRUE(recorder->Offer(kState, StateAt(tick), now_ns, {kProvider, ++sequence}));
    if (tick == 3) {
      ASSERT_TRUE(recorder->Offer(kStatus, StatusOf("one", 77), now_ns, {kAnn, 40}));
      ASSERT_TRUE(recorder->Offer(kStatus, StatusOf("two", 78), now_ns, {kAnn, 41}));
      ASSERT_TRUE(recorder->Offer(kCommand, CommandAt(tick), now_ns, {kBen, 1}));
    }
  }
}

TEST(NumberedFiles, BeginWithWhatIsStillValidAndCountItOnce) {
  testing::MemorySeries sink;
  RecorderOptions options;
  options.wait_for_capacity = true;
  options.files = RepeatingOptions();
  options.files.split_span = std::chrono::seconds(1);
  Recorder recorder(sink, LatchedTopics(), {}, options);
  OfferFourSeconds(&recorder);
  ASSERT_TRUE(recorder.Finish().ok());
  EXPECT_EQ(recorder.state().written, 403u);
  EXPECT_EQ(recorder.state().losses, TopicLosses{});
  const std::vector<Bytes> files = sink.files();
  ASSERT_EQ(files.size(), 4u);
  std::string repeated;
  std::set<std::tuple<std::string, std::string, std::uint32_t>> seen;
  int repetitions = 0;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const std::vector<InFile> messages = MessagesIn(files[i], &repeated);
    for (const InFile& message : messages) {
      repetitions +=
          seen.emplace(message.topic, message.writer_guid, message.sequence).second ? 0 : 1;
    }
    EXPECT_EQ(repeated, i == 0 ? "none" : "3");
    if (i == 0) continue;
    const std::int64_t begin_ns = kPeriod_ns * (100 * static_cast<std::int64_t>(i) + 1);
    const std::string ann = "01" + std::string(30, '0'), ben = "02" + std::string(30, '0');
    ASSERT_EQ(messages.size(), 103u);
    EXPECT_EQ(messages[0], (InFile{"component_status", ann, "writer 1", 40, begin_ns, 77}));
    EXPECT_EQ(messages[1], (InFile{"component_status", ann, "writer 1", 41, begin_ns, 78}));
    EXPECT_EQ(messages[2], (InFile{"operator_command", ben, "writer 2", 1, begin_ns, 0}));
    EXPECT_EQ(messages[3].topic, "joint_state");
    EXPECT_EQ(messages[3].log_time_ns, begin_ns);
  }
  EXPECT_EQ(seen.size(), 403u) << "joined, every message is there once";
  EXPECT_EQ(repetitions, 9);
}

TEST(NumberedFiles, KeepTheSequenceNumbersWhenTheyAreRecovered) {
  testing::MemorySeries sink;
  FilesOptions options = RepeatingOptions();
  RecordedFiles files(sink, LatchedTopics(), {}, options);
  ASSERT_TRUE(files.Begin().ok());
  RecordedMessage message = Sample(kStatus, kAnn, 40);
  message.payload = StatusOf("one", 77);
  ASSERT_TRUE(files.Write(message).ok());
  message.origin.sequence = 43;
  ASSERT_TRUE(files.Write(message).ok());
  ASSERT_TRUE(files.Tend(RecordedFiles::Instant{} + std::chrono::hours(1)).ok());
  ASSERT_TRUE(files.Tend(RecordedFiles::Instant{} + std::chrono::hours(2)).ok());
  const Bytes cut_off = sink.files().at(0);
  recording::MemorySource source(cut_off);
  const recording::McapReader reader(source);
  ASSERT_TRUE(reader.recovery().has_value());
  recording::MemorySink whole;
  ASSERT_TRUE(recording::RecoverMcap(reader, whole).ok());
  std::string repeated;
  const std::vector<InFile> messages = MessagesIn(whole.bytes(), &repeated);
  ASSERT_EQ(messages.size(), 2u);
  EXPECT_EQ(messages[0].sequence, 40u);
  EXPECT_EQ(messages[1].sequence, 43u);
}

TEST(RingFiles, BeginWithWhatTheRingHasForgotten) {
  testing::MemorySeries sink;
  RecorderOptions options;
  options.wait_for_capacity = true;
  options.files = RepeatingOptions();
  options.ring.last = std::chrono::seconds(1);
  Recorder recorder(sink, LatchedTopics(), {}, options);
  OfferFourSeconds(&recorder);
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (recorder.state().messages < 403u && std::chrono::steady_clock::now() < give_up) {
  }
  recorder.Trigger("SIGUSR1");
  ASSERT_TRUE(recorder.Finish().ok());
  ASSERT_EQ(sink.files().size(), 1u);
  std::string repeated;
  const std::vector<InFile> messages = MessagesIn(sink.files()[0], &repeated);
  EXPECT_EQ(repeated, "3");
  ASSERT_EQ(messages.size(), 104u);  // both ends of 1 s
  EXPECT_EQ(messages[0].sequence, 40u);
  EXPECT_EQ(messages[0].log_time_ns, kPeriod_ns * 300);
  EXPECT_EQ(messages[2].topic, "operator_command");
  EXPECT_EQ(messages[3].topic, "joint_state");
  EXPECT_EQ(recorder.state().written, 101u);
}

}  // namespace
}  // namespace sinew::logger
