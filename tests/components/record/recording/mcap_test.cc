#include <gtest/gtest.h>
#include <lz4frame.h>

#include <algorithm>
#include <boost/crc.hpp>
#include <functional>
#include <random>

#include "components/record/recording/mcap_reader.h"
#include "components/record/recording/mcap_writer.h"
#include "tests/support/memory_io.h"

namespace sinew::recording {
namespace {

Bytes AsBytes(std::string_view text) {
  Bytes bytes;
  PutRaw(&bytes, text);
  return bytes;
}

std::string AsText(std::span<const std::byte> bytes) { return Cursor::AsText(bytes); }

// A sink that takes so many bytes, like a disk.
class SmallDisk : public ByteSink {
 public:
  explicit SmallDisk(std::size_t capacity) : capacity_(capacity) {}
  IoStatus Write(std::span<const std::byte> bytes) override {
    ++writes_;
    if (bytes.size() > capacity_) return IoStatus::Failed("No space left on device");
    capacity_ -= bytes.size();
    return IoStatus::Ok();
  }
  int writes() const { return writes_; }

 private:
  std::size_t capacity_;
  int writes_ = 0;
};

struct Expected {
  std::string topic;
  std::int64_t log_time_ns;
  std::string data;
  bool operator==(const Expected&) const = default;
};

// Two topics, `count` messages 10 ms apart, chunks of 100 ms.
struct SampleFile {
  std::vector<Expected> messages;
  Bytes bytes;
  std::vector<std::uint64_t> sizes_after;  // file size when message i had been handed in
};

SampleFile MakeFile(int count, Compression compression = Compression::kZstd, bool close = true) {
  MemorySink sink;
  McapWriter writer(sink, {"test", compression, 100'000'000, 1u << 20});
  SampleFile file;
  SchemaId schema{};
  ChannelId first{};
  ChannelId second{};
  EXPECT_TRUE(writer.Open().ok());
  EXPECT_TRUE(writer.WriteMetadata({"run", {{"seed", "7"}, {"version", "1"}}}).ok());
  EXPECT_TRUE(writer.AddSchema("a::B", "omgidl", "struct B { octet x; };", &schema).ok());
  EXPECT_TRUE(writer.AddChannel(schema, "first", "cdr", {{"idl_hash", "1234"}}, &first).ok());
  EXPECT_TRUE(writer.AddChannel(schema, "second", "cdr", {}, &second).ok());
  for (int i = 0; i < count; ++i) {
    const std::int64_t time_ns = 1'000'000'000 + 10'000'000LL * i;
    const Expected message{i % 3 == 0 ? "second" : "first", time_ns,
                           "message " + std::to_string(i)};
    EXPECT_TRUE(
        writer
            .WriteMessage(i % 3 == 0 ? second : first, time_ns, time_ns - 5, AsBytes(message.data))
            .ok());
    file.messages.push_back(message);
    file.sizes_after.push_back(sink.bytes().size());
  }
  EXPECT_TRUE(writer.WriteAttachment({"config.yaml", "application/yaml", 5, "key: 1\n"}).ok());
  if (close) {
    EXPECT_TRUE(writer.Close().ok());
  }
  file.bytes = sink.bytes();
  return file;
}

std::vector<Expected> ReadAll(const McapReader& reader, MessageFilter filter = {}) {
  std::vector<Expected> all;
  McapMessages messages = reader.Messages(std::move(filter));
  McapMessage message;
  while (messages.Next(&message)) {
    all.push_back({reader.channels().at(message.channel_id).topic, message.log_time_ns,
                   AsText(message.data)});
  }
  return all;
}

class McapRoundTrip : public testing::TestWithParam<Compression> {};

TEST_P(McapRoundTrip, GivesBackEveryMessageAndTheSummary) {
  const SampleFile file = MakeFile(57, GetParam());
  MemorySource source(file.bytes);
  const McapReader reader(source);
  EXPECT_EQ(reader.profile(), "");
  EXPECT_EQ(reader.library(), "test");
  EXPECT_FALSE(reader.recovery().has_value());
  EXPECT_EQ(ReadAll(reader), file.messages);
  EXPECT_EQ(reader.statistics().message_count, 57u);
  EXPECT_EQ(reader.statistics().chunk_count, 6u);  // 570 ms in chunks of 100 ms
  EXPECT_EQ(reader.chunks().size(), 6u);
  EXPECT_EQ(reader.statistics().start_time_ns, 1'000'000'000);
  EXPECT_EQ(reader.statistics().end_time_ns, 1'560'000'000);
  EXPECT_EQ(reader.statistics().channel_message_counts.at(ChannelId{2}), 19u);
  EXPECT_EQ(reader.schemas().at(SchemaId{1}).data, "struct B { octet x; };");
  EXPECT_EQ(reader.channels().at(ChannelId{1}).metadata.at("idl_hash"), "1234");
  ASSERT_EQ(reader.ReadMetadata().size(), 1u);
  EXPECT_EQ(reader.ReadMetadata()[0].values.at("seed"), "7");
  ASSERT_EQ(reader.ReadAttachments().size(), 1u);
  EXPECT_EQ(reader.ReadAttachments()[0].data, "key: 1\n");
}

INSTANTIATE_TEST_SUITE_P(Compressions, McapRoundTrip,
                         testing::Values(Compression::kNone, Compression::kLz4,
                                         Compression::kZstd));

TEST(McapReader, FiltersTopicsAndTimes) {
  const SampleFile file = MakeFile(57);
  MemorySource source(file.bytes);
  const McapReader reader(source);
  MessageFilter filter;
  filter.topics = std::set<std::string>{"second"};
  filter.start_ns = 1'100'000'000;
  filter.end_ns = 1'300'000'000;
  std::vector<Expected> expected;
  for (const Expected& message : file.messages) {
    if (message.topic == "second" && message.log_time_ns >= filter.start_ns &&
        message.log_time_ns <= filter.end_ns) {
      expected.push_back(message);
    }
  }
  EXPECT_EQ(ReadAll(reader, filter), expected);
  EXPECT_EQ(expected.size(), 7u);
}

TEST(McapReader, MergesOverlappingChunksByTime) {
  MemorySink sink;
  McapWriter writer(sink, {"test", Compression::kNone, 1'000'000'000, 1u << 20});
  SchemaId schema{};
  ChannelId channel{};
  ASSERT_TRUE(writer.Open().ok());
  ASSERT_TRUE(writer.AddSchema("B", "omgidl", "", &schema).ok());
  ASSERT_TRUE(writer.AddChannel(schema, "topic", "cdr", {}, &channel).ok());
  for (const std::int64_t time : {10, 50, 30}) {
    ASSERT_TRUE(writer.WriteMessage(channel, time, time, AsBytes(std::to_string(time))).ok());
  }
  ASSERT_TRUE(writer.CloseChunk().ok());
  for (const std::int64_t time : {40, 20, 60}) {
    ASSERT_TRUE(writer.WriteMessage(channel, time, time, AsBytes(std::to_string(time))).ok());
  }
  ASSERT_TRUE(writer.Close().ok());
  MemorySource source(sink.bytes());
  const McapReader reader(source);
  std::vector<std::int64_t> times;
  for (const Expected& message : ReadAll(reader)) times.push_back(message.log_time_ns);
  EXPECT_EQ(times, (std::vector<std::int64_t>{10, 20, 30, 40, 50, 60}));
}

// The smallest file with a message, byte by byte as the specification has it.
TEST(McapWriter, WritesTheExactBytesOfATinyFile) {
  MemorySink sink;
  McapWriter writer(sink, {"lib", Compression::kNone, 100'000'000, 1u << 20});
  SchemaId schema{};
  ChannelId channel{};
  ASSERT_TRUE(writer.Open().ok());
  ASSERT_TRUE(writer.AddSchema("S", "omgidl", "x", &schema).ok());
  ASSERT_TRUE(writer.AddChannel(schema, "t", "cdr", {{"k", "v"}}, &channel).ok());
  ASSERT_TRUE(writer.WriteMessage(channel, 2, 1, AsBytes("ab")).ok());
  ASSERT_TRUE(writer.Close().ok());

  const auto crc_of = [](std::string_view text) {
    boost::crc_32_type crc;
    crc.process_bytes(text.data(), text.size());
    std::string out;
    for (int shift = 0; shift < 32; shift += 8) {
      out += static_cast<char>((crc.checksum() >> shift) & 0xff);
    }
    return out;
  };
  const auto u = [](std::uint64_t value, int bytes) {
    std::string out;
    for (int i = 0; i < bytes; ++i) out += static_cast<char>((value >> (8 * i)) & 0xff);
    return out;
  };
  const auto text = [&u](const std::string& value) { return u(value.size(), 4) + value; };
  const auto record = [&u](int opcode, const std::string& content) {
    return u(static_cast<std::uint64_t>(opcode), 1) + u(content.size(), 8) + content;
  };
  const std::string magic = "\x89MCAP0\r\n";
  const std::string schema_record = record(3, u(1, 2) + text("S") + text("omgidl") + text("x"));
  const std::string channel_record =
      record(4, u(1, 2) + u(1, 2) + text("t") + text("cdr") + u(10, 4) + text("k") + text("v"));
  const std::string message = record(5, u(1, 2) + u(0, 4) + u(2, 8) + u(1, 8) + "ab");
  const std::string chunk = record(6, u(2, 8) + u(2, 8) + u(message.size(), 8) + crc_of(message) +
                                          text("") + u(message.size(), 8) + message);
  const std::string index = record(7, u(1, 2) + u(16, 4) + u(2, 8) + u(0, 8));
  const std::string before_chunk =
      magic + record(1, text("") + text("lib")) + schema_record + channel_record;
  std::string file = before_chunk + chunk + index;
  file += record(15, crc_of(file));
  const std::size_t summary_start = file.size();
  const std::string statistics =
      record(11, u(1, 8) + u(1, 2) + u(1, 4) + u(0, 4) + u(0, 4) + u(1, 4) + u(2, 8) + u(2, 8) +
                     u(10, 4) + u(1, 2) + u(1, 8));
  const std::string chunk_index =
      record(8, u(2, 8) + u(2, 8) + u(before_chunk.size(), 8) + u(chunk.size(), 8) + u(10, 4) +
                    u(1, 2) + u(before_chunk.size() + chunk.size(), 8) + u(index.size(), 8) +
                    text("") + u(message.size(), 8) + u(message.size(), 8));
  std::string summary;
  std::string offsets;
  const auto group = [&](int opcode, const std::string& records) {
    offsets += record(14, u(static_cast<std::uint64_t>(opcode), 1) +
                              u(summary_start + summary.size(), 8) + u(records.size(), 8));
    summary += records;
  };
  group(3, schema_record);
  group(4, channel_record);
  group(11, statistics);
  group(8, chunk_index);
  std::string tail = summary + offsets + u(2, 1) + u(20, 8) + u(summary_start, 8) +
                     u(summary_start + summary.size(), 8);
  tail += crc_of(tail);
  file += tail + magic;
  EXPECT_EQ(AsText(sink.bytes()), file);
}

TEST(McapWriter, IsDeterministic) { EXPECT_EQ(MakeFile(40).bytes, MakeFile(40).bytes); }

TEST(McapWriter, ReportsAFullDiskAtOnceAndWritesNothingMore) {
  const std::size_t whole = MakeFile(57).bytes.size();
  for (std::size_t capacity = 0; capacity < whole; capacity += 37) {
    SmallDisk disk(capacity);
    McapWriter writer(disk, {"test", Compression::kZstd, 100'000'000, 1u << 20});
    SchemaId schema{};
    ChannelId channel{};
    bool reported = !writer.Open().ok();
    reported =
        !writer.AddSchema("a::B", "omgidl", "struct B { octet x; };", &schema).ok() || reported;
    reported = !writer.AddChannel(schema, "topic", "cdr", {}, &channel).ok() || reported;
    for (int i = 0; i < 200; ++i) {
      reported =
          !writer.WriteMessage(channel, 10'000'000LL * i, 0, AsBytes(std::string(20, 'x'))).ok() ||
          reported;
    }
    const int writes = disk.writes();
    if (reported) {
      const IoStatus again = writer.CloseChunk();
      EXPECT_EQ(again.message(), "No space left on device");
      EXPECT_FALSE(writer.Close().ok());
      EXPECT_EQ(disk.writes(), writes);
    } else {
      EXPECT_FALSE(writer.Close().ok()) << "capacity " << capacity;
    }
  }
}

TEST(McapWriter, RefusesWhatTheFormatCannotHold) {
  MemorySink sink;
  McapWriter writer(sink);
  ChannelId channel{};
  EXPECT_FALSE(writer.AddChannel(SchemaId{0}, "t", "cdr", {}, &channel).ok());  // not open
  ASSERT_TRUE(writer.Open().ok());
  EXPECT_FALSE(writer.Open().ok());
  EXPECT_FALSE(writer.AddChannel(SchemaId{1}, "t", "cdr", {}, &channel).ok());  // no such schema
  EXPECT_FALSE(writer.WriteMessage(ChannelId{1}, 0, 0, {}).ok());               // no such channel
  ASSERT_TRUE(writer.AddChannel(SchemaId{0}, "t", "cdr", {}, &channel).ok());
  EXPECT_FALSE(writer.WriteMessage(channel, -1, 0, {}).ok());
  EXPECT_TRUE(writer.WriteMessage(channel, 0, 0, {}).ok());
}

TEST(McapReader, RecoversEverythingUpToTheLastWholeChunkOfACutOffFile) {
  const SampleFile file = MakeFile(57, Compression::kZstd, /*close=*/false);
  MemorySource source(file.bytes);
  const McapReader reader(source);
  ASSERT_TRUE(reader.recovery().has_value());
  // The open chunk is lost: at most 100 ms, 10 messages.
  EXPECT_EQ(reader.recovery()->messages, 50u);
  const std::vector<Expected> first(file.messages.begin(), file.messages.begin() + 50);
  EXPECT_EQ(ReadAll(reader), first);
  EXPECT_EQ(reader.recovery()->lost_bytes, 0u);
  EXPECT_EQ(reader.ReadMetadata().size(), 1u);
}

// Cuts a file at every length: never a crash, always a prefix of the messages, and never fewer for
// more bytes.
TEST(McapReader, ReadsAPrefixOfEveryTruncatedFile) {
  const SampleFile file = MakeFile(57);
  std::size_t before = 0;
  std::size_t refused = 0;
  for (std::size_t length = 0; length < file.bytes.size(); ++length) {
    const Bytes part(file.bytes.begin(), file.bytes.begin() + static_cast<std::ptrdiff_t>(length));
    MemorySource source(part);
    std::vector<Expected> messages;
    try {
      const McapReader reader(source);
      ASSERT_TRUE(reader.recovery().has_value()) << length;
      EXPECT_EQ(reader.recovery()->good_bytes + reader.recovery()->lost_bytes, length);
      messages = ReadAll(reader);
    } catch (const McapError&) {
      ++refused;
      ASSERT_EQ(before, 0u) << "refused at length " << length;
      continue;
    }
    ASSERT_GE(messages.size(), before) << length;
    ASSERT_TRUE(std::equal(messages.begin(), messages.end(), file.messages.begin())) << length;
    before = messages.size();
  }
  EXPECT_EQ(before, file.messages.size());
  EXPECT_LT(refused, 40u);  // only while magic or header are not whole
}

// A damaged byte inside a whole file: an error that names a byte, or a file that still reads
// (unused bits, texts); never a crash, never a wrong message.
TEST(McapReader, NeverGivesAWrongMessageForAFlippedBit) {
  const SampleFile file = MakeFile(23);
  std::size_t refused = 0;
  for (std::size_t at = 8; at < file.bytes.size(); ++at) {
    Bytes damaged = file.bytes;
    damaged[at] ^= std::byte{0x10};
    MemorySource source(damaged);
    try {
      const McapReader reader(source);
      for (const Expected& message : ReadAll(reader)) {
        EXPECT_NE(std::find(file.messages.begin(), file.messages.end(), message),
                  file.messages.end())
            << at;
      }
    } catch (const McapError& error) {
      ++refused;
      EXPECT_NE(std::string(error.what()).find("byte "), std::string::npos);
    }
  }
  EXPECT_GT(refused, file.bytes.size() / 3);
}

TEST(McapReader, NamesTheByteOfAChunkWithAWrongChecksum) {
  SampleFile file = MakeFile(30, Compression::kNone);
  const std::string text = AsText(file.bytes);
  const std::size_t at = text.find("message 12");
  ASSERT_NE(at, std::string::npos);
  file.bytes[at] = std::byte{'M'};
  MemorySource source(file.bytes);
  const McapReader reader(source);
  McapMessages messages = reader.Messages();
  McapMessage message;
  int read = 0;
  try {
    while (messages.Next(&message)) ++read;
    FAIL() << "the wrong checksum was not seen";
  } catch (const McapError& error) {
    EXPECT_EQ(error.offset(), reader.chunks()[1].offset);
    EXPECT_STREQ(error.what(),
                 ("byte " + std::to_string(error.offset()) + ": the checksum of the chunk is wrong")
                     .c_str());
  }
  EXPECT_EQ(read, 10);  // the first chunk
}

TEST(McapReader, NeverCrashesOnRandomBytes) {
  std::mt19937_64 random(20240817);
  for (int round = 0; round < 3000; ++round) {
    Bytes bytes;
    if (round % 2 == 0) {
      for (const unsigned char byte : kMcapMagic) bytes.push_back(std::byte{byte});
      if (round % 4 == 0) {  // a valid header, then noise
        Put(&bytes, std::uint8_t{1});
        Put(&bytes, std::uint64_t{8});
        Put(&bytes, std::uint64_t{0});
      }
    }
    const auto size = random() % 400;
    for (std::uint64_t i = 0; i < size; ++i) {
      // Small numbers, so that lengths are often plausible.
      bytes.push_back(static_cast<std::byte>(random() % (round % 3 == 0 ? 256 : 16)));
    }
    if (round % 5 == 0) {
      for (const unsigned char byte : kMcapMagic) bytes.push_back(std::byte{byte});
    }
    MemorySource source(bytes);
    try {
      const McapReader reader(source);
      ReadAll(reader);
      reader.ReadMetadata();
      reader.ReadAttachments();
    } catch (const McapError&) {
    }
  }
}

TEST(McapReader, RefusesAFileOfAnotherFormat) {
  const Bytes bytes = AsBytes("time_s,position_rad\n0,1\n");
  MemorySource source(bytes);
  try {
    const McapReader reader(source);
    FAIL() << "read a CSV file";
  } catch (const McapError& error) {
    EXPECT_STREQ(error.what(), "byte 0: no MCAP file: the magic bytes are missing");
  }
}

// Files of other writers: messages without chunks, no summary.
TEST(McapReader, ReadsUnchunkedFilesWithoutASummary) {
  Bytes bytes;
  const auto record = [&bytes](int opcode, const Bytes& content) {
    Put(&bytes, static_cast<std::uint8_t>(opcode));
    Put(&bytes, static_cast<std::uint64_t>(content.size()));
    bytes.insert(bytes.end(), content.begin(), content.end());
  };
  for (const unsigned char byte : kMcapMagic) bytes.push_back(std::byte{byte});
  Bytes content;
  PutText(&content, "");
  PutText(&content, "other");
  record(1, content);
  content.clear();
  Put(&content, std::uint16_t{3});
  Put(&content, std::uint16_t{0});
  PutText(&content, "topic");
  PutText(&content, "json");
  Put(&content, std::uint32_t{0});
  record(4, content);
  for (const std::uint64_t time : {30u, 10u, 20u}) {
    content.clear();
    Put(&content, std::uint16_t{3});
    Put(&content, std::uint32_t{0});
    Put(&content, time);
    Put(&content, time);
    PutRaw(&content, "{}");
    record(5, content);
  }
  record(0x80, AsBytes("an extension to be ignored"));
  record(15, Bytes(4, std::byte{0}));
  record(2, Bytes(20, std::byte{0}));
  for (const unsigned char byte : kMcapMagic) bytes.push_back(std::byte{byte});
  MemorySource source(bytes);
  const McapReader reader(source);
  EXPECT_FALSE(reader.recovery().has_value());
  const std::vector<Expected> messages = ReadAll(reader);
  ASSERT_EQ(messages.size(), 3u);
  EXPECT_EQ(messages[0].log_time_ns, 10);
  EXPECT_EQ(messages[2].log_time_ns, 30);
}

// A file whose summary has other records, or none, as other writers leave them out.
// loose: records before the end of the data.
Bytes WithSummary(const Bytes& bytes, const std::function<bool(Opcode)>& keep, bool channels_first,
                  bool has_summary = true, const Bytes& loose = {}) {
  MemorySource source(bytes);
  const McapRecords records(source);
  std::vector<McapRecord> data, summary;
  bool ended = false;
  for (std::uint64_t offset = kMcapMagic.size(); offset < bytes.size() - kMcapMagic.size();) {
    const McapRecord record = records.ReadHead(offset, bytes.size());
    offset = record.end();
    if (record.opcode == Opcode::kFooter) break;
    if (!ended) {
      data.push_back(record);
    } else if (record.opcode != Opcode::kSummaryOffset && keep(record.opcode)) {
      summary.push_back(record);
    }
    ended = ended || record.opcode == Opcode::kDataEnd;
  }
  if (channels_first) {
    std::stable_partition(summary.begin(), summary.end(), [](const McapRecord& record) {
      return record.opcode == Opcode::kChannel;
    });
  }
  const auto data_end = bytes.begin() + static_cast<std::ptrdiff_t>(data.back().offset);
  Bytes out(bytes.begin(), data_end);
  out.insert(out.end(), loose.begin(), loose.end());
  out.insert(out.end(), data_end, bytes.begin() + static_cast<std::ptrdiff_t>(data.back().end()));
  const std::uint64_t start = out.size();
  for (const McapRecord& record : summary) {
    out.insert(out.end(), bytes.begin() + static_cast<std::ptrdiff_t>(record.offset),
               bytes.begin() + static_cast<std::ptrdiff_t>(record.end()));
  }
  Put(&out, static_cast<std::uint8_t>(Opcode::kFooter));
  Put(&out, std::uint64_t{20});
  Put(&out, has_summary ? start : std::uint64_t{0});
  Put(&out, std::uint64_t{0});
  Put(&out, std::uint32_t{0});
  for (const unsigned char byte : kMcapMagic) out.push_back(std::byte{byte});
  return out;
}

TEST(McapReader, ReadsWhateverASummaryLeavesOut) {
  const SampleFile file = MakeFile(57);
  const auto expect_whole = [&file](const Bytes& bytes, const std::string& what) {
    MemorySource source(bytes);
    const McapReader reader(source);
    EXPECT_FALSE(reader.recovery().has_value()) << what;
    EXPECT_EQ(ReadAll(reader), file.messages) << what;
    ASSERT_NE(reader.SchemaOf(reader.channels().at(ChannelId{1})), nullptr) << what;
    EXPECT_EQ(reader.SchemaOf(reader.channels().at(ChannelId{1}))->name, "a::B") << what;
    EXPECT_EQ(reader.ReadMetadata().size(), 1u) << what;
    EXPECT_EQ(reader.ReadAttachments().size(), 1u) << what;
    EXPECT_EQ(reader.statistics().message_count, 57u) << what;
  };
  expect_whole(WithSummary(
                   file.bytes, [](Opcode) { return true; }, true),
               "channels first");
  for (const Opcode left_out :
       {Opcode::kSchema, Opcode::kChannel, Opcode::kChunkIndex, Opcode::kStatistics,
        Opcode::kMetadataIndex, Opcode::kAttachmentIndex}) {
    expect_whole(WithSummary(
                     file.bytes, [=](Opcode opcode) { return opcode != left_out; }, false),
                 OpcodeText(left_out));
  }
  expect_whole(WithSummary(
                   file.bytes, [](Opcode) { return false; }, false, false),
               "no summary");
}

// A summary has no index of them, and its statistics need not count them.
TEST(McapReader, ReadsMessagesOutsideOfChunksBesideASummary) {
  SampleFile file = MakeFile(57);
  Bytes loose;
  Put(&loose, static_cast<std::uint8_t>(Opcode::kMessage));
  Put(&loose, std::uint64_t{22 + 5});
  Put(&loose, std::uint16_t{1});  // channel
  Put(&loose, std::uint32_t{0});
  Put(&loose, std::uint64_t{2'000'000'000});
  Put(&loose, std::uint64_t{0});
  PutRaw(&loose, "loose");
  const Bytes bytes = WithSummary(
      file.bytes, [](Opcode) { return true; }, false, true, loose);
  MemorySource source(bytes);
  const McapReader reader(source);
  file.messages.push_back({"first", 2'000'000'000, "loose"});
  EXPECT_EQ(ReadAll(reader), file.messages);
  EXPECT_EQ(reader.statistics().message_count, 58u);
  EXPECT_EQ(reader.ReadAttachments().size(), 1u);
}

TEST(McapReader, RefusesAChunkThatDeclaresMoreThanItHolds) {
  Bytes compressed;
  Compress(Compression::kZstd, AsBytes("short"), &compressed);
  Bytes out;
  EXPECT_NE(Decompress("zstd", compressed, std::uint64_t{1} << 60, &out), "");
  EXPECT_NE(Decompress("zstd", compressed, 3, &out), "");
  EXPECT_EQ(Decompress("zstd", compressed, 5, &out), "");
  EXPECT_EQ(AsText(out), "short");
  EXPECT_NE(Decompress("brotli", compressed, 5, &out), "");
}

// A gigabyte of zeros is 32 kB of zstd, which really holds it.
TEST(McapReader, RefusesAChunkThatHoldsMoreThanRecordingsDo) {
  constexpr std::uint64_t kPicture = std::uint64_t{64} << 20;
  EXPECT_EQ(MostUncompressed(33000), kPicture);
  EXPECT_EQ(MostUncompressed(kPicture), 255 * kPicture);
  Bytes bomb;
  Compress(Compression::kZstd, Bytes(kPicture + 1), &bomb);
  Bytes out;
  EXPECT_EQ(Decompress("zstd", bomb, kPicture + 1, &out),
            std::to_string(bomb.size()) +
                " compressed bytes are said to hold 67108865, expected at most 67108864");
  EXPECT_EQ(out.capacity(), 0u);
}

// A long run: half an hour at 240 Hz keeps memory bounded (chunks leave) and stays readable.
// A file name in Latin-1, as a ZIP of Windows has it.
TEST(McapWriter, NamesThatAreNoUtf8HaveReplacementCharacters) {
  MemorySink sink;
  McapWriter writer(sink);
  ASSERT_TRUE(writer.Open().ok());
  ASSERT_TRUE(writer.WriteMetadata({"run", {{"file", "Fl\xFCgel.csv"}}}).ok());
  ASSERT_TRUE(writer.WriteAttachment({"Fl\xFCgel.csv", "text/csv", 0, "\xFC"}).ok());
  ASSERT_TRUE(writer.Close().ok());
  MemorySource source(sink.bytes());
  const McapReader reader(source);
  EXPECT_EQ(reader.ReadMetadata().at(0).values.at("file"), "Fl\uFFFDgel.csv");
  EXPECT_EQ(reader.ReadAttachments().at(0).name, "Fl\uFFFDgel.csv");
  EXPECT_EQ(reader.ReadAttachments().at(0).data, "\xFC") << "contents are what they are";
}

TEST(McapWriter, KeepsHalfAnHourOfMessages) {
  MemorySink sink;
  McapWriter writer(sink);
  SchemaId schema{};
  ChannelId channel{};
  ASSERT_TRUE(writer.Open().ok());
  ASSERT_TRUE(writer.AddSchema("B", "omgidl", "", &schema).ok());
  ASSERT_TRUE(writer.AddChannel(schema, "topic", "cdr", {}, &channel).ok());
  const int count = 240 * 60 * 30;
  Bytes data(64);
  for (int i = 0; i < count; ++i) {
    PutAt(&data, 0, i);
    ASSERT_TRUE(writer.WriteMessage(channel, i * 4'166'667LL, 0, data).ok());
  }
  ASSERT_TRUE(writer.Close().ok());
  MemorySource source(sink.bytes());
  const McapReader reader(source);
  EXPECT_EQ(reader.statistics().message_count, static_cast<std::uint64_t>(count));
  McapMessages messages = reader.Messages();
  McapMessage message;
  int next = 0;
  while (messages.Next(&message)) {
    Cursor cursor(message.data);
    ASSERT_EQ(cursor.Get<int>(), next);
    ASSERT_EQ(message.sequence, static_cast<std::uint32_t>(next));
    ++next;
  }
  EXPECT_EQ(next, count);
}

}  // namespace
}  // namespace sinew::recording
