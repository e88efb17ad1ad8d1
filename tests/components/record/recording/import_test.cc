// CSV -> recording -> runs: the same numbers, bit by bit.
#include "components/record/recording/file/import.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include "components/base/config/config.h"
#include "components/record/recording/csv_map.h"
#include "components/record/recording/file/file_io.h"
#include "components/record/recording/file/run_reader.h"
#include "components/record/recording/mcap_reader.h"
#include "components/record/recording/run_builder.h"
#include "components/record/recording/signal_fields.h"
#include "tests/components/record/logger/messages.h"
#include "tests/support/memory_io.h"
#include "tests/support/skip.h"

namespace sinew::recording {
namespace {

namespace fs = std::filesystem;
using sinew::testing::SchemaOf;
using types::Signal;

class Import : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::path(::testing::TempDir()) /
        ("import_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path Write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  fs::path folder_;
};

void ExpectSame(const types::Run& a, const types::Run& b) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_EQ(a.content_hash, b.content_hash);
  ASSERT_EQ(a.signals.size(), b.signals.size());
  for (Eigen::Index i = 0; i < a.size(); ++i) {
    ASSERT_EQ(std::llround(a.time_s[i] * 1e9), std::llround(b.time_s[i] * 1e9)) << i;
  }
  for (const auto& [signal, values] : a.signals) {
    ASSERT_TRUE(b.Has(signal)) << types::SignalName(signal);
    for (Eigen::Index i = 0; i < a.size(); ++i) {
      ASSERT_EQ(std::bit_cast<std::uint64_t>(values[i]),
                std::bit_cast<std::uint64_t>(b.At(signal)[i]))
          << types::SignalName(signal) << " " << i;
    }
  }
}

// Signals that topics carry.
std::vector<Signal> RecordedSignals() {
  std::vector<Signal> signals = types::AllSignals();
  std::erase_if(signals, [](Signal signal) { return !OnTopics(signal); });
  return signals;
}

// Every signal of a recording, with odd numbers, two files.
std::string AllSignalsMap() {
  std::string map = "schema: sinew-csv-map/1\nkind: rotary\ntime: {column: t, unit: s}\nsignals:\n";
  for (const Signal signal : RecordedSignals()) {
    const std::string name(types::SignalName(signal));
    map += "  " + name + ": {column: " + name +
           ", unit: " + std::string(types::SignalUnit(signal, types::JointKind::kRevolute)) + "}\n";
  }
  return map;
}

std::string AllSignalsCsv(int rows, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::string csv = "t";
  for (const Signal signal : RecordedSignals()) csv += "," + std::string(types::SignalName(signal));
  csv += "\n";
  char text[64];
  double time_s = 0.0003;
  for (int row = 0; row < rows; ++row) {
    time_s += 0.001 + 1e-4 * static_cast<double>(random() % 10);
    std::snprintf(text, sizeof(text), "%.5f", time_s);
    csv += text;
    for (const Signal signal : RecordedSignals()) {
      const double value = static_cast<double>(random() % 2000001) / 1e3 - 1000.0;
      std::snprintf(text, sizeof(text), signal == Signal::kValveOpen ? ",%.0f" : ",%.17g",
                    signal == Signal::kValveOpen ? static_cast<double>(row % 2) : value / 3.0);
      csv += text;
    }
    csv += "\n";
  }
  return csv;
}

TEST_F(Import, KeepsEverySignalBitByBitAndEveryFileASession) {
  const fs::path map = Write("map.yaml", AllSignalsMap());
  const fs::path a = Write("a.csv", AllSignalsCsv(700, 1));
  const fs::path b = Write("b.csv", AllSignalsCsv(300, 2));
  const fs::path out = folder_ / "run.mcap";
  std::uint64_t reported = 0;
  const ImportResult result =
      ImportFiles({a, b}, map, out, SchemaOf, [&reported](std::uint64_t done, std::uint64_t all) {
        reported = done;
        EXPECT_EQ(all, 1000u);
      });
  EXPECT_EQ(reported, 1000u);
  EXPECT_EQ(result.samples, 1000u);
  EXPECT_EQ(result.messages, 3000u);
  const std::vector<types::Run> runs = ReadRuns(out);
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_EQ(runs[0].name, out.string() + "#1");
  ExpectSame(ReadRuns(a, map).at(0), runs[0]);
  ExpectSame(ReadRuns(b, map).at(0), runs[1]);
  // Nothing is left beside the file.
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 4);
}

TEST_F(Import, ARangeOfARecordingIsThatOfItsCsvAndSessionsOutsideAreLeftOut) {
  const fs::path map = Write("map.yaml",
                             "schema: sinew-csv-map/1\nkind: linear\ntime: {column: t, unit: s}\n"
                             "signals:\n  position: {column: x, unit: m}\n");
  const fs::path a = Write("a.csv", "t,x\n0,1\n1,2\n2,3\n3,4\n");
  const fs::path b = Write("b.csv", "t,x\n100,1\n101,2\n102,3\n");
  const std::string out = folder_ / "run.mcap";
  ImportFiles({a, b}, map, out, SchemaOf);
  const std::vector<types::Run> runs = ReadRuns(out + "@1:3");
  ASSERT_EQ(runs.size(), 1u);
  ExpectSame(ReadRuns(a.string() + "@1:3", map).at(0), runs[0]);
  EXPECT_EQ(runs[0].size(), 2);
  try {
    ReadRuns(out + "@10:20");
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_EQ(std::string(error.what()),
              out +
                  "#2: no row in the range '10:20' (s), the recording's clock goes from 100 to 102 "
                  "s");
  }
}

TEST_F(Import, LeavesOutASignalThatNoTopicCarriesAndTheContentIsTheSame) {
  const std::string map =
      "schema: sinew-csv-map/1\nkind: rotary\ntime: {column: t, unit: s}\nsignals:\n"
      "  position: {column: q, unit: rad}\n";
  const fs::path with = Write("with.yaml", map + "  supply_voltage: {column: u, unit: V}\n");
  const fs::path csv = Write("a.csv", "t,q,u\n0,1,7\n1,2,8\n2,3,7\n");
  ImportFiles({csv}, with, folder_ / "run.mcap", SchemaOf);
  const types::Run run = ReadRuns(folder_ / "run.mcap").at(0);
  EXPECT_FALSE(run.Has(Signal::kSupplyVoltage));
  EXPECT_EQ(run.content_hash, ReadRuns(csv, with).at(0).content_hash);
}

TEST_F(Import, StampsAreExactNanosecondsAndHeadersSayReplay) {
  const fs::path map = Write("map.yaml",
                             "schema: sinew-csv-map/1\nkind: linear\ntime: {column: t, unit: s}\n"
                             "signals:\n  position: {column: x, unit: m}\n");
  const fs::path csv = Write("a.csv", "t,x\n0.000000001,1\n0.123456789,2\n1234567.123456789,3\n");
  ImportFiles({csv}, map, folder_ / "run.mcap", SchemaOf);
  FileSource source(folder_ / "run.mcap");
  const McapReader reader(source);
  MessageFilter filter;
  filter.topics = std::set<std::string>{"joint_state"};
  McapMessages messages = reader.Messages(filter);
  const IdlSchema schema = IdlSchema::Parse(SchemaOf("joint_state").idl);
  const IdlType& type = schema.Struct("sinew::msg::JointState");
  const std::vector<std::int64_t> stamps = {1, 123456789, 1234567123456789};
  McapMessage message;
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    ASSERT_TRUE(messages.Next(&message));
    EXPECT_EQ(message.publish_time_ns, stamps[i]);
    EXPECT_EQ(CdrField(type, "header.stamp_ns").AsInt(message.data), stamps[i]);
    EXPECT_EQ(CdrField(type, "header.tick").AsInt(message.data), static_cast<std::int64_t>(i));
    EXPECT_EQ(CdrField(type, "header.origin").AsText(message.data), "ORIGIN_REPLAY");
    EXPECT_EQ(CdrField(type, "joint_kind[0]").AsText(message.data), "JOINT_PRISMATIC");
    EXPECT_EQ(CdrField(type, "last_tick").AsInt(message.data), i == 2 ? 1 : 0);
  }
  EXPECT_FALSE(messages.Next(&message));
  EXPECT_EQ(ReadRuns(folder_ / "run.mcap").at(0).kind, types::JointKind::kPrismatic);
}

TEST_F(Import, KeepsMeasuredDataOfAnotherRig) {
  const fs::path data = fs::path(SINEW_SHARED_DIR) / "data/emps/DATA_EMPS.csv";
  SKIP_WITHOUT_DATA(data);
  const fs::path map =
      Write("map.yaml",
            "schema: sinew-csv-map/1\nkind: linear\ntime: {column: time_s, unit: s}\n"
            "signals:\n  position: {column: q_meas_m, unit: m}\n"
            "  drive_voltage: {column: u_V, unit: V}\n"
            "  reference_position: {column: q_ref_m, unit: m}\n");
  ImportFiles({data}, map, folder_ / "run.mcap", SchemaOf);
  const types::Run expected = ReadRuns(data, map).at(0);
  const types::Run run = ReadRuns(folder_ / "run.mcap").at(0);
  ExpectSame(expected, run);
  for (Eigen::Index i = 0; i < run.size(); ++i) ASSERT_EQ(run.time_s[i], expected.time_s[i]);
}

TEST_F(Import, RefusesTimeBeforeZeroAndLeavesNothingBehind) {
  const fs::path map = Write("map.yaml",
                             "schema: sinew-csv-map/1\nkind: linear\ntime: {column: t, unit: s}\n"
                             "signals:\n  position: {column: x, unit: m}\n");
  const fs::path csv = Write("a.csv", "t,x\n-1,1\n1,2\n");
  EXPECT_THROW(ImportFiles({csv}, map, folder_ / "run.mcap", SchemaOf), UsageError);
  EXPECT_FALSE(fs::exists(folder_ / "run.mcap"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 2);
  EXPECT_THROW(ImportFiles({csv}, map, folder_ / "no/such/folder/run.mcap", SchemaOf), UsageError);
}

TEST_F(Import, RunsSayWhatIsWrongWithAFile) {
  const fs::path map = Write("map.yaml", AllSignalsMap());
  const fs::path csv = Write("a.csv", AllSignalsCsv(300, 1));
  const fs::path out = folder_ / "run.mcap";
  ImportFiles({csv}, map, out, SchemaOf);
  const auto error_of = [](auto call) -> std::string {
    try {
      call();
    } catch (const UsageError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(error_of([&] { ReadRuns(csv); }),
            csv.string() + ": no recording (.mcap), expected a mapping file to read it as CSV");
  EXPECT_EQ(error_of([&] { ReadRuns(out, {}, 1); }),
            out.string() + ": joint 1 is asked for, topic 'joint_state' has joints 0 to 0");
  EXPECT_NE(error_of([&] { ReadRuns(csv, map, 1); }), "");
  EXPECT_NE(error_of([&] { ReadRuns(folder_ / "absent.mcap"); }), "");
  EXPECT_NE(error_of([&] { ReadRuns(folder_ / "absent.csv", map); }), "");
  const fs::path broken = Write("broken.mcap", "no recording at all");
  EXPECT_EQ(error_of([&] { ReadRuns(broken); }),
            broken.string() + ": byte 0: no MCAP file: the magic bytes are missing");
}

TEST_F(Import, ReadsWhatIsThereOfACutOffRecording) {
  const fs::path map = Write("map.yaml", AllSignalsMap());
  const fs::path csv = Write("a.csv", AllSignalsCsv(1000, 1));
  const fs::path out = folder_ / "run.mcap";
  ImportFiles({csv}, map, out, SchemaOf);
  fs::resize_file(out, fs::file_size(out) / 2);
  const types::Run whole = ReadRuns(csv, map).at(0);
  const types::Run part = ReadRuns(out).at(0);
  EXPECT_GT(part.size(), 100);
  EXPECT_LT(part.size(), whole.size());
  EXPECT_EQ(part.At(Signal::kLoadForce), whole.At(Signal::kLoadForce).head(part.size()));
}

// Rows without a valid joint or actuator sample are left out; a reference lost for a tick is held.
TEST(RunBuilder, LeavesInvalidRowsOutAndHoldsTheSetPoint) {
  MemorySink sink;
  McapWriter writer(sink);
  ASSERT_TRUE(writer.Open().ok());
  struct Channel {
    IdlSchema schema;
    const IdlType* type;
    ChannelId id{};
  };
  std::map<std::string, Channel> channels;
  for (const std::string name : {"joint_state", "actuator_state", "reference"}) {
    const TopicSchema schema = SchemaOf(name);
    Channel& channel = channels[name];
    channel.schema = IdlSchema::Parse(schema.idl);
    channel.type = &channel.schema.Struct(schema.type_name);
    ASSERT_TRUE(AddTopic(schema, &writer, &channel.id).ok());
  }
  const auto write = [&](const std::string& name, int tick,
                         const std::map<std::string, double>& fields) {
    const Channel& channel = channels.at(name);
    Bytes message = ZeroCdr(*channel.type);
    CdrField(*channel.type, "header.tick").SetInt(message, tick);
    CdrField(*channel.type, "header.stamp_ns").SetInt(message, tick * 1000);
    CdrField(*channel.type, "joint_count").SetInt(message, 2);
    for (const auto& [path, value] : fields) CdrField(*channel.type, path).Set(message, value);
    ASSERT_TRUE(writer.WriteMessage(channel.id, tick, tick, message).ok());
  };
  const double flags =
      types::SignalBit(Signal::kPosition) | types::SignalBit(Signal::kMotorCurrent);
  for (int tick = 0; tick < 10; ++tick) {
    write("joint_state", tick, {{"position_rad[1]", 0.1 * tick}, {"valid[1]", tick == 4 ? 0 : 1}});
    if (tick != 6) {
      write("actuator_state", tick,
            {{"motor_current_A[1]", 5.0 * tick}, {"valid[1]", 1}, {"measured_flags", flags}});
    }
    if (tick == 2) {
      write("reference", tick, {{"joint_count", 0}});  // asks for nothing
    } else if (tick != 8) {
      write("reference", tick, {{"position_rad[1]", 1.0 + tick}});
    }
    if (tick == 3)
      write("joint_state", tick, {{"position_rad[1]", 99}, {"valid[1]", 1}});  // sent twice
  }
  ASSERT_TRUE(writer.Close().ok());
  MemorySource source(sink.bytes());
  const McapReader reader(source);
  const std::vector<types::Run> runs = RunsOfRecording(reader, "memory", 1);
  ASSERT_EQ(runs.size(), 1u);
  const types::Run& run = runs[0];
  EXPECT_EQ(run.name, "memory");
  ASSERT_EQ(run.size(), 8);
  EXPECT_EQ(run.time_s[3], 3e-6);
  EXPECT_EQ(run.time_s[4], 5e-6);
  EXPECT_EQ(run.At(Signal::kPosition)[3], 0.1 * 3);
  EXPECT_EQ(run.At(Signal::kMotorCurrent)[4], 25.0);
  EXPECT_FALSE(run.Has(Signal::kVelocity));  // not measured
  EXPECT_EQ(run.At(Signal::kReferencePosition)[1], 2.0);
  EXPECT_EQ(run.At(Signal::kReferencePosition)[2], 0.1 * 2);  // where it is
  EXPECT_EQ(run.At(Signal::kReferencePosition)[6], 8.0);      // tick 8 holds tick 7
  EXPECT_EQ(run.At(Signal::kReferencePosition)[7], 10.0);
  EXPECT_THROW(RunsOfRecording(reader, "memory", 2), std::invalid_argument);
  EXPECT_THROW(RunsOfRecording(reader, "memory", 0), std::invalid_argument);  // never valid
}

TEST(SignalFields, HaveARowForEverySignalAndFieldsThatExist) {
  ASSERT_EQ(SignalFields().size(), RecordedSignals().size());
  for (const SignalField& field : SignalFields()) {
    const TopicSchema schema = SchemaOf(field.topic);
    const IdlSchema idl = IdlSchema::Parse(schema.idl);
    EXPECT_TRUE(HasField(idl.Struct(schema.type_name), std::string(field.field) + "[0]"))
        << field.field;
  }
}

TEST(SignalFields, AreThoseOfTheDocumentation) {
  const std::string text = config::ReadFile(fs::path(SINEW_SOURCE_DIR) / "docs/formats.md");
  for (const SignalField& field : SignalFields()) {
    const std::string row = "| " + std::to_string(static_cast<int>(field.signal)) + " | `" +
                            std::string(types::SignalName(field.signal)) + "` | `" +
                            std::string(field.topic) + "." + std::string(field.field) + "` |";
    EXPECT_NE(text.find(row), std::string::npos) << row;
  }
}

}  // namespace
}  // namespace sinew::recording
