#include "components/record/logger/recorded_files.h"

#include <gtest/gtest.h>

#include "components/record/logger/message_ring.h"
#include "components/record/recording/run_builder.h"
#include "tests/components/record/logger/memory_series.h"
#include "tests/components/record/logger/messages.h"
#include "tests/support/memory_io.h"

namespace sinew::logger {
namespace {

using recording::Bytes;
using recording::McapReader;
using testing::MakeMessage;
using testing::MemorySeries;
using testing::SchemaOf;

constexpr WriterGuid kOneWriter = {1, 2, 3};
constexpr WriterGuid kOtherWriter = {0xab, 0xcd};

RecordedMessage MessageAt(std::int64_t time_ns, const WriterGuid& writer = {}) {
  static const Bytes kPayload = MakeMessage("joint_state", {});
  return {0, kPayload, time_ns, time_ns, {writer, 0}};
}

std::string LastValue(const McapReader& reader, const std::string& record, const std::string& key) {
  std::string value = "no record";
  for (const recording::McapMetadata& metadata : reader.ReadMetadata()) {
    if (metadata.name == record) value = metadata.values.at(key);
  }
  return value;
}

// Writes messages 10 ms apart and gives the files.
std::vector<Bytes> WriteSeries(int count, FilesOptions options) {
  MemorySeries sink;
  RecordedFiles files(sink, {SchemaOf("joint_state"), SchemaOf("reference")},
                      {{"sinew.recording", {{"seed", "3"}}}}, std::move(options));
  EXPECT_TRUE(files.Begin().ok());
  for (int i = 0; i < count; ++i) {
    EXPECT_TRUE(files.Write(MessageAt(1'000'000'000 + 10'000'000LL * i)).ok());
  }
  EXPECT_TRUE(files.End().ok());
  EXPECT_EQ(sink.ended(), sink.files().size());
  EXPECT_EQ(files.messages(), static_cast<std::uint64_t>(count));
  return sink.files();
}

// Reception times over all files, each of which must be whole and carry everything.
std::vector<std::int64_t> TimesOf(const std::vector<Bytes>& files) {
  std::vector<std::int64_t> times;
  for (std::size_t i = 0; i < files.size(); ++i) {
    recording::MemorySource source(files[i]);
    const McapReader reader(source);
    EXPECT_FALSE(reader.recovery().has_value());
    EXPECT_EQ(reader.schemas().size(), 2u);
    EXPECT_EQ(LastValue(reader, "sinew.recording", "seed"), "3");
    EXPECT_EQ(LastValue(reader, "sinew.losses", "all.lost"), "0");
    if (files.size() > 1) {
      EXPECT_EQ(LastValue(reader, "sinew.split", "number"), std::to_string(i));
    }
    EXPECT_EQ(reader.ReadAttachments().size(), 1u);
    recording::McapMessages messages = reader.Messages();
    recording::McapMessage message;
    while (messages.Next(&message)) times.push_back(message.log_time_ns);
  }
  return times;
}

std::vector<std::int64_t> ExpectedTimes(int count) {
  std::vector<std::int64_t> times;
  for (int i = 0; i < count; ++i) times.push_back(1'000'000'000 + 10'000'000LL * i);
  return times;
}

FilesOptions WithAttachment() {
  FilesOptions options;
  options.attachments = {{"rig.yaml", "application/yaml", 0, "a: 1\n"}};
  return options;
}

TEST(RecordedFiles, IsOneFileUnlessItIsSplit) {
  const std::vector<Bytes> files = WriteSeries(300, WithAttachment());
  EXPECT_EQ(files.size(), 1u);
  EXPECT_EQ(TimesOf(files), ExpectedTimes(300));
}

TEST(RecordedFiles, LosesNothingWhereItIsSplitByTime) {
  FilesOptions options = WithAttachment();
  options.split_span = std::chrono::seconds(1);
  const std::vector<Bytes> files = WriteSeries(350, options);
  EXPECT_EQ(files.size(), 4u);  // 3.5 s in files of 1 s
  EXPECT_EQ(TimesOf(files), ExpectedTimes(350));
}

TEST(RecordedFiles, LosesNothingWhereItIsSplitBySize) {
  FilesOptions options = WithAttachment();
  options.compression = recording::Compression::kNone;
  options.split_bytes = 64u << 10;
  const std::vector<Bytes> files = WriteSeries(2000, options);
  EXPECT_GT(files.size(), 10u);
  EXPECT_EQ(TimesOf(files), ExpectedTimes(2000));
  const std::size_t chunk = 11 * (MessageAt(0).payload.size() + 64);  // 100 ms of messages
  for (const Bytes& file : files) {
    EXPECT_LT(file.size(), options.split_bytes + 2 * chunk + 8000) << "data, one chunk, an index";
  }
}

TEST(RecordedFiles, AFullDiskLeavesTheFilesBeforeItWhole) {
  MemorySeries sink(100'000);
  FilesOptions options = WithAttachment();
  options.compression = recording::Compression::kNone;
  options.split_bytes = 30'000;
  RecordedFiles files(sink, {SchemaOf("joint_state"), SchemaOf("reference")},
                      {{"sinew.recording", {{"seed", "3"}}}}, options);
  recording::IoStatus status = files.Begin();
  int written = 0;
  for (; status.ok() && written < 10'000; ++written) {
    status = files.Write(MessageAt(1'000'000'000 + 10'000'000LL * written));
  }
  EXPECT_EQ(status.message(), "No space left on device");
  std::vector<Bytes> whole = sink.files();
  ASSERT_GE(whole.size(), 3u);
  recording::MemorySource last(whole.back());
  const McapReader cut_off(last);  // opens
  EXPECT_TRUE(cut_off.recovery().has_value());
  whole.pop_back();
  const std::vector<std::int64_t> times = TimesOf(whole);
  EXPECT_EQ(times, ExpectedTimes(static_cast<int>(times.size())));
  EXPECT_GT(times.size(), 50u);
}

TEST(RecordedFiles, EveryWriterOfATopicHasAChannelWithItsName) {
  MemorySeries sink;
  FilesOptions options;
  options.describe_writer = [](const WriterGuid& writer) {
    return recording::TextMap{{"participant", writer == kOneWriter ? "one" : "other"}};
  };
  RecordedFiles files(sink, {SchemaOf("joint_state")}, {}, options);
  ASSERT_TRUE(files.Begin().ok());
  for (int i = 0; i < 30; ++i) {
    ASSERT_TRUE(files.Write(MessageAt(i, i % 3 == 0 ? kOneWriter : kOtherWriter)).ok());
  }
  ASSERT_TRUE(files.End().ok());
  const std::vector<Bytes> written = sink.files();
  recording::MemorySource source(written.at(0));
  const McapReader reader(source);
  ASSERT_EQ(reader.channels().size(), 2u);
  EXPECT_EQ(reader.schemas().size(), 1u);
  std::map<std::string, std::uint64_t> counts;
  std::map<std::string, std::string> guids;
  for (const auto& [id, channel] : reader.channels()) {
    EXPECT_EQ(channel.topic, "joint_state");
    const std::string& name = channel.metadata.at("participant");
    counts[name] = reader.statistics().channel_message_counts.at(id);
    guids[name] = channel.metadata.at("writer_guid");
  }
  EXPECT_EQ(counts, (std::map<std::string, std::uint64_t>{{"one", 10}, {"other", 20}}));
  EXPECT_EQ(guids.at("one"), "01020300000000000000000000000000");
  EXPECT_EQ(guids.at("other"), "abcd0000000000000000000000000000");
}

TEST(RecordedFiles, ARunIsReadFromAllWritersOfItsTopic) {
  MemorySeries sink;
  RecordedFiles files(sink, {SchemaOf("joint_state")}, {}, {});
  ASSERT_TRUE(files.Begin().ok());
  for (int tick = 0; tick < 30; ++tick) {  // the provider was started again, or another took over
    const Bytes payload = MakeMessage("joint_state", {{"header.session_id", 5},
                                                      {"header.tick", tick},
                                                      {"header.stamp_ns", 1e6 * tick},
                                                      {"joint_count", 1},
                                                      {"valid[0]", 1},
                                                      {"position_rad[0]", 0.5 * tick}});
    ASSERT_TRUE(
        files.Write({0, payload, tick, tick, {tick < 10 ? kOneWriter : kOtherWriter, 0}}).ok());
  }
  ASSERT_TRUE(files.End().ok());
  const std::vector<Bytes> written = sink.files();
  recording::MemorySource source(written.at(0));
  const McapReader reader(source);
  ASSERT_EQ(reader.channels().size(), 2u);
  const std::vector<types::Run> runs = recording::RunsOfRecording(reader, "run.mcap", 0);
  ASSERT_EQ(runs.size(), 1u);
  ASSERT_EQ(runs[0].size(), 30);
  for (Eigen::Index i = 0; i < 30; ++i) {
    EXPECT_EQ(runs[0].At(types::Signal::kPosition)[i], 0.5 * static_cast<double>(i));
  }
}

TEST(RecordedFiles, NotesLossesWhileItRecordsAndAtTheEnd) {
  MemorySeries sink;
  RecordedFiles files(sink, {SchemaOf("joint_state"), SchemaOf("reference")}, {}, {});
  ASSERT_TRUE(files.Begin().ok());
  ASSERT_TRUE(files.Write(MessageAt(1)).ok());
  files.SetLosses(
      std::vector<TopicLosses>{{}, {.lost = 2, .missing = 3, .dropped = 4, .malformed = 0}});
  ASSERT_TRUE(files.Tend(RecordedFiles::Instant{} + std::chrono::hours(1)).ok());
  {
    const std::vector<Bytes> killed = sink.files();  // without its end
    recording::MemorySource source(killed.at(0));
    const McapReader reader(source);
    ASSERT_TRUE(reader.recovery().has_value());
    EXPECT_EQ(LastValue(reader, "sinew.losses", "reference.missing"), "3");
  }
  files.SetLosses(
      std::vector<TopicLosses>{{}, {.lost = 5, .missing = 3, .dropped = 4, .malformed = 0}});
  ASSERT_TRUE(files.End().ok());
  const std::vector<Bytes> written = sink.files();
  recording::MemorySource source(written.at(0));
  const McapReader reader(source);
  EXPECT_EQ(LastValue(reader, "sinew.losses", "reference.lost"), "5");
  EXPECT_EQ(LastValue(reader, "sinew.losses", "all.dropped"), "4");
  EXPECT_THROW(LastValue(reader, "sinew.losses", "joint_state.lost"), std::out_of_range);
}

TEST(RecordedFiles, ClosesAChunkThatIsOldAndSyncsAsOftenAsItSays) {
  MemorySeries sink;
  FilesOptions options;
  options.sync_span = std::chrono::seconds(1);
  RecordedFiles files(sink, {SchemaOf("joint_state")}, {}, options);
  ASSERT_TRUE(files.Begin().ok());
  const auto size = [&sink] { return sink.files().at(0).size(); };
  RecordedFiles::Instant now{std::chrono::hours(1)};
  ASSERT_TRUE(files.Tend(now).ok());
  EXPECT_EQ(sink.syncs(), 1);  // of the file's beginning
  ASSERT_TRUE(files.Write(MessageAt(1)).ok());
  ASSERT_TRUE(files.Tend(now).ok());
  const std::size_t before = size();
  ASSERT_TRUE(files.Tend(now + std::chrono::milliseconds(99)).ok());
  EXPECT_EQ(size(), before);
  ASSERT_TRUE(files.Tend(now + std::chrono::milliseconds(100)).ok());
  EXPECT_GT(size(), before) << "the chunk is in the file";
  EXPECT_EQ(sink.syncs(), 1);
  ASSERT_TRUE(files.Tend(now + std::chrono::milliseconds(1000)).ok());
  EXPECT_EQ(sink.syncs(), 2);
  ASSERT_TRUE(files.Tend(now + std::chrono::milliseconds(2000)).ok());
  EXPECT_EQ(sink.syncs(), 2) << "nothing new";
}

TEST(MessageRing, KeepsTheSpanAndNoMore) {
  MessageRing ring(std::chrono::nanoseconds(100), 1u << 20);
  for (int i = 0; i < 50; ++i) ring.Push(MessageAt(10 * i));
  EXPECT_EQ(ring.size(), 11u);  // both ends of 100 ns in steps of 10
  EXPECT_EQ(ring.Pop()->reception_ns, 390);
  EXPECT_EQ(ring.forgotten(), 0u);
}

TEST(MessageRing, IsBoundedInBytes) {
  const std::size_t each = sizeof(RecordedMessage) + MessageAt(0).payload.size();
  MessageRing ring(std::chrono::hours(1), 10 * each);
  for (int i = 0; i < 50; ++i) ring.Push(MessageAt(i));
  EXPECT_EQ(ring.size(), 10u);
  EXPECT_EQ(ring.forgotten(), 40u);
  for (int i = 40; i < 50; ++i) EXPECT_EQ(ring.Pop()->reception_ns, i);
  EXPECT_FALSE(ring.Pop().has_value());
}

}  // namespace
}  // namespace sinew::logger
