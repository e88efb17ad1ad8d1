// Bags of ROS 2 in both storages and byte orders -> runs and recordings: the same numbers, bit by
// bit. The encoder here is written from the .msg files and the CDR specification (RTPS 2.5, 10.2).
#include "components/record/recording/file/ros_bag.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <random>

#include "components/base/config/config.h"
#include "components/record/recording/file/csv_map_file.h"
#include "components/record/recording/file/file_io.h"
#include "components/record/recording/file/import.h"
#include "components/record/recording/file/run_reader.h"
#include "components/record/recording/mcap_reader.h"
#include "components/record/recording/mcap_writer.h"
#include "tests/components/record/logger/messages.h"
#include "tests/support/temporary_folder.h"

namespace sinew::recording {
namespace {

namespace fs = std::filesystem;
using sinew::testing::SchemaOf;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using types::Signal;

constexpr std::int64_t kStart_ns = 1'700'000'000'250'000'000;
constexpr std::int64_t kLogDelay_ns = 700'000;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
const std::string kJointState = "sensor_msgs/msg/JointState";
const std::string kWrench = "geometry_msgs/msg/WrenchStamped";

class Encoder {
 public:
  explicit Encoder(bool big_endian) : big_endian_(big_endian) {
    bytes_[1] = std::byte{big_endian ? std::uint8_t{0} : std::uint8_t{1}};
  }
  template <class Number>
  void Put(Number value) {
    while ((bytes_.size() - 4) % sizeof(value) != 0) bytes_.push_back(std::byte{0xEE});
    auto raw = std::bit_cast<std::array<std::byte, sizeof(value)>>(value);
    if (big_endian_) std::reverse(raw.begin(), raw.end());
    bytes_.insert(bytes_.end(), raw.begin(), raw.end());
  }
  void Text(const std::string& text) {
    Put(static_cast<std::uint32_t>(text.size() + 1));
    PutRaw(&bytes_, text);
    bytes_.push_back(std::byte{0});
  }
  void Header(std::int64_t stamp_ns) {
    Put(static_cast<std::int32_t>(stamp_ns / 1'000'000'000));
    Put(static_cast<std::uint32_t>(stamp_ns % 1'000'000'000));
    Text("base");
  }
  void Doubles(const std::vector<double>& list) {
    Put(static_cast<std::uint32_t>(list.size()));
    for (const double value : list) Put(value);
  }
  const Bytes& bytes() const { return bytes_; }

 private:
  bool big_endian_;
  Bytes bytes_ = Bytes(4);
};

struct Joint {
  std::string name;
  double position = 0.0, velocity = 0.0, effort = 0.0;
};

Bytes JointStateBytes(std::int64_t stamp_ns, const std::vector<Joint>& joints, bool has_effort,
                      bool big_endian = false) {
  Encoder out(big_endian);
  out.Header(stamp_ns);
  out.Put(static_cast<std::uint32_t>(joints.size()));
  std::vector<double> position, velocity, effort;
  for (const Joint& joint : joints) {
    out.Text(joint.name);
    position.push_back(joint.position);
    velocity.push_back(joint.velocity);
    if (has_effort) effort.push_back(joint.effort);
  }
  out.Doubles(position);
  out.Doubles(velocity);
  out.Doubles(effort);
  return out.bytes();
}

Bytes WrenchBytes(std::int64_t stamp_ns, double force_z_N) {
  Encoder out(false);
  out.Header(stamp_ns);
  for (const double value : {0.0, 0.0, force_z_N, 0.0, 0.0, 0.0}) out.Put(value);
  return out.bytes();
}

struct Sent {
  std::string topic, type;
  std::int64_t log_ns;
  Bytes bytes;
};

void WriteMcap(const fs::path& path, const std::vector<Sent>& messages) {
  FileSink sink(path, Existing::kRefuse);
  McapWriter writer(sink);
  ASSERT_TRUE(writer.Open("ros2").ok());
  std::map<std::string, ChannelId> channels;
  for (const Sent& sent : messages) {
    if (!channels.contains(sent.topic)) {
      SchemaId schema{};
      ASSERT_TRUE(writer.AddSchema(sent.type, "ros2msg", "of the type", &schema).ok());
      ASSERT_TRUE(writer.AddChannel(schema, sent.topic, "cdr", {}, &channels[sent.topic]).ok());
    }
    ASSERT_TRUE(
        writer.WriteMessage(channels[sent.topic], sent.log_ns, sent.log_ns, sent.bytes).ok());
  }
  ASSERT_TRUE(writer.Close().ok() && sink.Close().ok());
}

// As rosbag2_storage_sqlite3 makes them.
void WriteSqlite(const fs::path& path, const std::vector<Sent>& messages) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
  const auto run = [&](const std::string& sql, const Bytes& blob = {}) {
    sqlite3_stmt* statement = nullptr;
    ASSERT_EQ(sqlite3_prepare_v2(database, sql.c_str(), -1, &statement, nullptr), SQLITE_OK) << sql;
    if (!blob.empty()) {
      sqlite3_bind_blob(statement, 1, blob.data(), static_cast<int>(blob.size()), SQLITE_STATIC);
    }
    ASSERT_EQ(sqlite3_step(statement), SQLITE_DONE) << sql;
    sqlite3_finalize(statement);
  };
  run("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
      "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL)");
  run("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER "
      "NOT NULL, data BLOB NOT NULL)");
  run("CREATE INDEX timestamp_idx ON messages (timestamp ASC)");
  run("BEGIN");
  std::map<std::string, std::size_t> topics;
  for (const Sent& sent : messages) {
    const auto [topic, is_new] = topics.try_emplace(sent.topic, topics.size() + 1);
    const std::string id = std::to_string(topic->second);
    if (is_new) {
      run("INSERT INTO topics VALUES(" + id + ",'" + sent.topic + "','" + sent.type +
          "','cdr','')");
    }
    run("INSERT INTO messages(topic_id, timestamp, data) VALUES(" + id + "," +
            std::to_string(sent.log_ns) + ",?)",
        sent.bytes);
  }
  run("COMMIT");
  sqlite3_close(database);
}

class RosBag : public ::testing::Test {
 protected:
  // A folder with so many files; gives its path.
  fs::path Write(const std::vector<Sent>& messages, bool sqlite = false, std::size_t files = 1,
                 const std::string& more_metadata = "") {
    const fs::path bag = folder_.path() / ("bag_" + std::to_string(bags_++));
    fs::create_directory(bag);
    std::string metadata =
        "rosbag2_bagfile_information:\n  version: 5\n" + more_metadata + "  relative_file_paths:\n";
    for (std::size_t k = 0; k < files; ++k) {
      const auto at = [&](std::size_t n) {
        return messages.begin() + static_cast<std::ptrdiff_t>(n * messages.size() / files);
      };
      // A name that sorts before those of earlier files: metadata.yaml has the order.
      const std::string name = std::to_string(files - k) + (sqlite ? ".db3" : ".mcap");
      metadata += "    - " + name + "\n";
      (sqlite ? WriteSqlite : WriteMcap)(bag / name, {at(k), at(k + 1)});
    }
    folder_.Write(bag.filename() / "metadata.yaml", metadata);
    return bag;
  }
  fs::path Import(const fs::path& bag, const fs::path& map = {},
                  std::vector<std::string>* notes = nullptr) {
    const fs::path out = folder_.path() / (bag.stem().string() + "_imported.mcap");
    const ImportResult result = ImportFiles({bag}, map, out, SchemaOf);
    if (notes != nullptr) *notes = result.notes;
    return out;
  }
  template <class Matcher>
  void ExpectRefused(const fs::path& bag, const Matcher& matcher, const fs::path& map = {}) {
    try {
      ReadRuns(bag, map);
      FAIL() << bag << " was read";
    } catch (const UsageError& error) {
      EXPECT_THAT(std::string(error.what()), matcher);
    }
  }
  // One joint that moves.
  std::vector<Sent> Moving(int messages) {
    std::vector<Sent> sent;
    for (int i = 0; i < messages; ++i) {
      const std::int64_t stamp_ns = kStart_ns + 2'000'000 * i;
      sent.push_back({"/joint_states", kJointState, stamp_ns + kLogDelay_ns,
                      JointStateBytes(stamp_ns, {{"hip", 0.1 * i, 50.0, 1.0}}, true)});
    }
    return sent;
  }

  testing::TemporaryFolder folder_;
  int bags_ = 0;
};

TEST_F(RosBag, ReadsEveryNumberInBothStoragesAndByteOrdersWhateverTheOrderOfTheJoints) {
  for (unsigned seed = 0; seed < 16; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(-3.0, 3.0);
    const bool sqlite = seed % 2 == 1, big_endian = seed / 2 % 2 == 1, effort = seed / 4 % 2 == 0;
    std::vector<Joint> joints = {{"knee"}, {"left/hip_yaw"}, {"ankle 1"}};
    std::map<std::string, std::vector<Joint>> expected;
    std::vector<Sent> messages;
    for (int i = 0; i < 60; ++i) {
      const std::int64_t stamp_ns = kStart_ns + 4'000'000 * i + static_cast<int>(random() % 4096);
      for (Joint& joint : joints) {
        joint = {joint.name, uniform(random), uniform(random), uniform(random)};
        expected[joint.name].push_back(joint);
      }
      const std::string topic = seed / 8 == 0 ? "/joint_states" : "/arm/joint_states";
      messages.push_back({topic, kJointState, stamp_ns + kLogDelay_ns,
                          JointStateBytes(stamp_ns, joints, effort, big_endian)});
      messages.push_back({"/tf", "tf2_msgs/msg/TFMessage", stamp_ns + kLogDelay_ns, Bytes(32)});
      std::shuffle(joints.begin(), joints.end(), random);
    }
    const fs::path bag = Write(messages, sqlite, 1 + seed % 3);
    std::vector<std::string> notes;
    const fs::path recording = Import(bag, {}, &notes);
    EXPECT_THAT(notes, Contains(HasSubstr("/tf (tf2_msgs/msg/TFMessage)")));
    EXPECT_THAT(notes, Contains(HasSubstr("joint_states: position (rad), velocity (rad/s)" +
                                          std::string(effort ? ", effort (Nm)" : "") +
                                          " of joints 0 knee, 1 left/hip_yaw, 2 ankle 1")));
    const char* names[] = {"knee", "left/hip_yaw", "ankle 1"};
    for (int j = 0; j < 3; ++j) {
      const types::Run direct = ReadRuns(bag, {}, j).at(0), run = ReadRuns(recording, {}, j).at(0);
      EXPECT_EQ(direct.content_hash, run.content_hash);
      ASSERT_EQ(run.size(), 60);
      EXPECT_EQ(run.Has(Signal::kTorque), effort);
      EXPECT_FALSE(run.Has(Signal::kMotorPosition));
      for (Eigen::Index i = 0; i < run.size(); ++i) {
        const Joint& joint = expected[names[j]][static_cast<std::size_t>(i)];
        ASSERT_EQ(run.At(Signal::kPosition)[i], joint.position);
        ASSERT_EQ(run.At(Signal::kVelocity)[i], joint.velocity);
        if (effort) {
          ASSERT_EQ(run.At(Signal::kTorque)[i], joint.effort);
        }
      }
    }
  }
}

TEST_F(RosBag, TakesSignsAndUnitsFromAMappingAsACsvFileDoes) {
  const std::string map = folder_.Write(
      "map.yaml",
      "schema: sinew-csv-map/1\nkind: rotary\njoint_names: [hip]\n"
      "time: {column: /joint_states/header/stamp, unit: s, offset: -1.7e9}\nsignals:\n"
      "  position: {column: '/joint_states/{joint}/position', unit: deg, sign: -1}\n"
      "  motor_current: {column: '/joint_states/{joint}/effort', unit: mA}\n");
  const types::Run run = ReadRuns(Write(Moving(5)), map).at(0);
  EXPECT_DOUBLE_EQ(run.At(Signal::kPosition)[3], -(0.1 * 3) * M_PI / 180.0);
  EXPECT_EQ(run.At(Signal::kMotorCurrent)[0], 1e-3);
  EXPECT_NEAR(run.time_s[1], 0.252, 1e-6);
  ExpectRefused(Write(Moving(5)),
                AllOf(HasSubstr("wrong.yaml:4: key 'signals.position.column': no column "
                                "'/joint_states/knee/position' in "),
                      HasSubstr("expected one of: /joint_states/header/stamp, "
                                "/joint_states/hip/effort, ")),
                folder_.Write("wrong.yaml",
                              "schema: sinew-csv-map/1\nkind: rotary\n"
                              "time: {column: /joint_states/header/stamp, unit: s}\nsignals: "
                              "{position: {column: /joint_states/knee/position, unit: rad}}\n"));
  ExpectRefused(Write(Moving(5)),
                HasSubstr("messages have stamps, expected 'time: {column: TOPIC/header/stamp"),
                folder_.Write("numbered.yaml",
                              "schema: sinew-csv-map/1\nkind: rotary\ntime: {row_period_s: 1}\n"
                              "signals: {position: {column: /joint_states/hip/position, unit: "
                              "rad}}\n"));
  EXPECT_THROW(ParseCsvMap("schema: sinew-csv-map/1\nkind: rotary\njoints: 2\njoint_names: [a]\n"
                           "time: {column: t, unit: s}\nsignals: {position: {column: q, unit: rad}}"
                           "\n",
                           "map.yaml"),
               UsageError);
}

TEST_F(RosBag, InterpolatesOtherTopicsAndLeavesOutRowsWhereTheyAreNot) {
  std::vector<Sent> messages = Moving(40);  // every 2 ms
  // Every 5 ms from 10 ms on, none from 35 to 60 ms: force 1000 N/s.
  for (const int ms : {10, 15, 20, 25, 30, 35, 60, 65}) {
    const std::int64_t stamp_ns = kStart_ns + 1'000'000 * ms;
    messages.push_back({"/wrench", kWrench, stamp_ns, WrenchBytes(stamp_ns, ms)});
  }
  const std::string map = folder_.Write(
      "map.yaml",
      "schema: sinew-csv-map/1\nkind: rotary\n"
      "time: {column: /joint_states/header/stamp, unit: s, offset: -1700000000.25}\nsignals:\n"
      "  position: {column: /joint_states/hip/position, unit: rad}\n"
      "  load_force: {column: /wrench/wrench/force/z, unit: N}\n");
  const types::Run run = ReadRuns(Write(messages), map).at(0);
  for (Eigen::Index i = 0; i < run.size(); ++i) {
    const double ms = run.time_s[i] * 1e3;
    EXPECT_NEAR(run.At(Signal::kLoadForce)[i], ms, 1e-3);  // 240 ns of a double's epoch time
    EXPECT_TRUE((ms > 9.9 && ms < 35.1) || (ms > 59.9 && ms < 65.1)) << ms;
  }
  EXPECT_EQ(run.size(), 13 + 3);  // 10, 12 .. 34 and 60, 62, 64
  std::vector<std::string> notes;
  Import(Write(messages), map, &notes);
  EXPECT_THAT(notes, Contains(HasSubstr("16 of 40 messages")));
}

TEST_F(RosBag, RecordsAJointAsNotValidWhereMessagesDoNotHaveIt) {
  std::vector<Sent> messages;
  for (int i = 0; i < 20; ++i) {
    const std::int64_t stamp_ns = kStart_ns + 1'000'000 * i;
    const double lost = i == 6 ? kNaN : 0.5;
    messages.push_back({"/joint_states", kJointState, stamp_ns,
                        i % 2 == 0
                            ? JointStateBytes(stamp_ns, {{"hip", 1.0 * i, lost, 0.0}}, true)
                            : JointStateBytes(stamp_ns, {{"grip", -1.0 * i, 0.5, 0.0}}, true)});
  }
  const fs::path bag = Write(messages), recording = Import(bag);
  for (int j = 0; j < 2; ++j) {
    const types::Run direct = ReadRuns(bag, {}, j).at(0), run = ReadRuns(recording, {}, j).at(0);
    EXPECT_EQ(run.size(), j == 0 ? 9 : 10);
    EXPECT_EQ(run.content_hash, direct.content_hash);
    EXPECT_EQ(run.At(Signal::kPosition)[4], j == 0 ? 10.0 : -9.0);
  }
}

TEST_F(RosBag, UsesTheTimesOfTheLogWhereEveryStampIsZeroAndReportsItOnce) {
  std::vector<Sent> messages = Moving(10);
  for (Sent& sent : messages) sent.bytes = JointStateBytes(0, {{"hip", 1.0, 2.0, 3.0}}, true);
  std::vector<std::string> notes;
  const types::Run run = ReadRuns(Import(Write(messages), {}, &notes)).at(0);
  EXPECT_EQ(std::count_if(notes.begin(), notes.end(),
                          [](const std::string& note) {
                            return note.find("topic '/joint_states': every header.stamp is 0") !=
                                   std::string::npos;
                          }),
            1);
  EXPECT_NEAR(run.time_s[0], 1'700'000'000.2507, 1e-6);
  // One stamp of 0 is the first of a simulation.
  messages = Moving(10);
  for (int i = 0; i < 10; ++i) {
    messages[static_cast<std::size_t>(i)].bytes =
        JointStateBytes(i * 1'000'000, {{"hip", 1.0, 2.0, 3.0}}, true);
  }
  EXPECT_EQ(ReadRuns(Write(messages)).at(0).time_s[0], 0.0);
}

TEST_F(RosBag, RefusesEveryTruncatedMessageByFileTopicAndNumber) {
  const std::vector<Sent> whole = Moving(2);
  const fs::path bag = Write(whole);
  for (std::size_t size = 0; size < whole[1].bytes.size(); ++size) {
    RosTable table("bag");
    const Sent& sent = whole[1];
    const auto add = [&](std::size_t bytes) {
      table.Add({sent.topic, sent.type, "cdr", 0, std::span(sent.bytes).first(bytes)}, "a.mcap");
    };
    add(sent.bytes.size());
    try {
      add(size);
      FAIL() << size << " bytes were read";
    } catch (const std::invalid_argument& error) {
      EXPECT_THAT(std::string(error.what()),
                  AllOf(HasSubstr("a.mcap: topic '/joint_states', message 2: "),
                        HasSubstr(", expected a sensor_msgs/msg/JointState")));
    }
  }
  // Random bytes are refused or read, and nothing else happens.
  std::mt19937 random(1);
  for (int i = 0; i < 2000; ++i) {
    Bytes bytes = whole[0].bytes;
    for (int k = 0; k < 4; ++k) bytes[random() % bytes.size()] = std::byte(random() % 256);
    RosTable table("bag");
    try {
      table.Add({"/joint_states", kJointState, "cdr", 0, bytes}, "a.mcap");
    } catch (const std::invalid_argument&) {
    }
  }
  std::vector<Sent> cut = Moving(3);
  cut[2].bytes.resize(40);
  ExpectRefused(Write(cut, true), HasSubstr("1.db3: topic '/joint_states', message 3: "));
}

TEST_F(RosBag, RefusesWhatIsNoMessageOfItsTypeByWhatWasExpected) {
  std::vector<Sent> doubled = Moving(3);
  doubled[1].bytes = JointStateBytes(kStart_ns, {{"hip"}, {"hip"}}, true);
  ExpectRefused(Write(doubled), AllOf(HasSubstr("'hip/position' is there twice"),
                                      HasSubstr("with each joint once")));
  std::vector<Sent> ragged = Moving(3);
  Encoder out(false);
  out.Header(kStart_ns);
  out.Put(std::uint32_t{0});
  for (int k = 0; k < 3; ++k) out.Doubles({1.0});
  ragged[1].bytes = out.bytes();
  ExpectRefused(Write(ragged),
                HasSubstr("message 2: 'position' has 1 entries and 'name' 0, expected a "));
  std::vector<Sent> back = Moving(3);
  std::swap(back[0].bytes, back[1].bytes);
  ExpectRefused(Write(back),
                HasSubstr(": message 2: column '/joint_states/header/stamp': time 17000"));
}

TEST_F(RosBag, IsAFolderAnSqliteFileOrAnMcapFileOfItsProfile) {
  EXPECT_TRUE(IsRosBag(Write(Moving(3))));
  EXPECT_TRUE(IsRosBag(Write(Moving(3)) / "1.mcap"));
  EXPECT_TRUE(IsRosBag(Write(Moving(3), true) / "1.db3"));
  EXPECT_FALSE(IsRosBag(Import(Write(Moving(3)))));
  EXPECT_FALSE(IsRosBag(folder_.Write("short.mcap", "\x89MCAP0\r\n")));
  EXPECT_FALSE(IsRosBag(folder_.Write("data.csv", "t,q\n0,1\n")));
  try {
    Import(folder_.Write("data.csv", "t,q\n0,1\n"));
    FAIL() << "a CSV file was imported without a mapping";
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr("data.csv: a CSV file needs a mapping, expected --map"));
  }
}

TEST_F(RosBag, RefusesABagWithoutSomethingToRead) {
  ExpectRefused(Write({}),
                HasSubstr("has no message, expected some of sensor_msgs/msg/JointState"));
  ExpectRefused(Write({}, true), HasSubstr("has no message, expected some of "));
  ExpectRefused(Write({{"/tf", "tf2_msgs/msg/TFMessage", kStart_ns, Bytes(8)}}),
                HasSubstr("has messages of /tf (tf2_msgs/msg/TFMessage) alone"));
  ExpectRefused(Write({{"/wrench", kWrench, kStart_ns, WrenchBytes(kStart_ns, 1.0)}}),
                AllOf(HasSubstr("has 0 topics of sensor_msgs/msg/JointState, expected one"),
                      HasSubstr("/wrench/wrench/force/z")));
  ExpectRefused(
      Write(Moving(3), true, 1, "  compression_format: zstd\n  compression_mode: MESSAGE\n"),
      HasSubstr("metadata.yaml: compressed ('zstd', by MESSAGE), expected a bag without"));
  EXPECT_EQ(ReadRuns(Write(Moving(3), true, 1, "  compression_mode: \"\"\n")).size(), 1u);
  const fs::path lost = Write(Moving(3));
  fs::remove(lost / "metadata.yaml");
  ExpectRefused(lost, HasSubstr("a folder without metadata.yaml"));
  EXPECT_EQ(ReadRuns(lost / "1.mcap").at(0).size(), 3) << "one file of a bag is one";
  fs::path gone = Write(Moving(3), true);
  EXPECT_EQ(ReadRuns(gone / "1.db3").at(0).size(), 3);
  fs::remove(gone / "1.db3");
  ExpectRefused(gone, HasSubstr("1.db3: No such file"));
  ExpectRefused(folder_.Write("text.db3", "no database, long enough for a header of one\n"),
                HasSubstr("text.db3: file is not a database, expected a bag of ROS 2"));
  ExpectRefused(
      fs::path(folder_.Write("bag/metadata.yaml", "other: 1\n")).parent_path(),
      AllOf(HasSubstr("metadata.yaml: "), HasSubstr(", expected rosbag2_bagfile_information")));
}

}  // namespace
}  // namespace sinew::recording
