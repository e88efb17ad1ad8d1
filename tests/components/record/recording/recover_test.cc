#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <tuple>
#include <vector>

#include "components/record/recording/mcap_recover.h"
#include "components/record/recording/mcap_writer.h"
#include "tests/support/memory_io.h"

namespace sinew::recording {
namespace {

using Seen = std::tuple<std::string, std::int64_t, std::string>;  // topic, log time, data

Bytes WriteLong(Compression compression) {
  MemorySink sink;
  McapWriter writer(sink, {"test", compression, 100'000'000, 1u << 20});
  SchemaId schema{};
  ChannelId channels[2];
  EXPECT_TRUE(writer.Open().ok());
  EXPECT_TRUE(writer.WriteMetadata({"run", {{"seed", "7"}}}).ok());
  EXPECT_TRUE(writer.WriteAttachment({"a.yaml", "application/yaml", 5, "key: 1\n"}).ok());
  EXPECT_TRUE(writer.AddSchema("a::B", "omgidl", "struct B { octet x; };", &schema).ok());
  for (ChannelId& channel : channels) {  // two writers of one topic
    EXPECT_TRUE(writer.AddChannel(schema, "topic", "cdr", {{"writer", "w"}}, &channel).ok());
  }
  std::mt19937 random(5);
  for (int i = 0; i < 400; ++i) {
    Bytes data(1 + random() % 60, std::byte{static_cast<unsigned char>(i)});
    EXPECT_TRUE(writer.WriteMessage(channels[i % 2], 10'000'000LL * i, i, data).ok());
  }
  EXPECT_TRUE(writer.Close().ok());
  return sink.bytes();
}

std::vector<Seen> AllOf(const McapReader& reader) {
  std::vector<Seen> seen;
  McapMessages messages = reader.Messages();
  McapMessage message;
  while (messages.Next(&message)) {
    seen.emplace_back(reader.channels().at(message.channel_id).topic, message.log_time_ns,
                      Cursor::AsText(message.data));
  }
  return seen;
}

class McapRecover : public testing::TestWithParam<Compression> {};

TEST_P(McapRecover, MakesAWholeFileOfEveryCut) {
  const Bytes whole = WriteLong(GetParam());
  MemorySource whole_source(whole);
  const McapReader whole_reader(whole_source);
  const std::vector<Seen> expected = AllOf(whole_reader);
  ASSERT_EQ(expected.size(), 400u);
  const std::uint64_t header_end = 8 + 9 + 4 + 4 + 4;  // magic, head, two texts: "", "test"

  std::mt19937 random(11);
  std::uniform_int_distribution<std::size_t> anywhere(header_end, whole.size() - 1);
  std::size_t longest = 0;
  for (int round = 0; round < 150; ++round) {
    const std::size_t cut = anywhere(random);
    SCOPED_TRACE("cut at byte " + std::to_string(cut) + " of " + std::to_string(whole.size()));
    const Bytes part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(cut));
    MemorySource source(part);
    const McapReader reader(source);
    ASSERT_TRUE(reader.recovery().has_value());
    MemorySink sink;
    ASSERT_TRUE(RecoverMcap(reader, sink).ok());

    MemorySource recovered_source(sink.bytes());
    const McapReader recovered(recovered_source);
    ASSERT_FALSE(recovered.recovery().has_value());
    const std::vector<Seen> got = AllOf(recovered);
    ASSERT_EQ(got.size(), reader.recovery()->messages);
    ASSERT_TRUE(std::equal(got.begin(), got.end(), expected.begin()));
    // Lost is at most the chunk that was cut: whole chunks before the cut are all there.
    std::size_t whole_chunks = 0;
    for (const McapChunkIndex& chunk : whole_reader.chunks()) {
      whole_chunks += chunk.offset + chunk.length <= cut ? 1 : 0;
    }
    ASSERT_EQ(recovered.statistics().chunk_count, whole_chunks);
    EXPECT_EQ(reader.recovery()->good_bytes + reader.recovery()->lost_bytes, cut);
    const std::vector<McapMetadata> metadata = recovered.ReadMetadata();
    EXPECT_EQ(metadata.back().name, "sinew.recovered");
    EXPECT_EQ(metadata.back().values.at("messages"), std::to_string(got.size()));
    longest = std::max(longest, got.size());
  }
  EXPECT_GT(longest, 300u);
}

INSTANTIATE_TEST_SUITE_P(Compressions, McapRecover,
                         testing::Values(Compression::kNone, Compression::kLz4,
                                         Compression::kZstd));

TEST(McapRecoverSink, ReportsAFullDisk) {
  class FullDisk : public ByteSink {
   public:
    IoStatus Write(std::span<const std::byte>) override { return IoStatus::Failed("full"); }
  };
  Bytes part = WriteLong(Compression::kNone);
  part.resize(part.size() - 1);
  MemorySource source(part);
  const McapReader reader(source);
  FullDisk sink;
  EXPECT_EQ(RecoverMcap(reader, sink).message(), "full");
}

}  // namespace
}  // namespace sinew::recording
