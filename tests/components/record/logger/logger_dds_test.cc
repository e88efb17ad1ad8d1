// Logger, player and the commands around them as processes over DDS. Domains 20 to 34.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "components/base/config/config.h"
#include "components/record/recording/file/file_io.h"
#include "components/record/recording/file/run_reader.h"
#include "components/record/recording/mcap_reader.h"
#include "components/record/recording/mcap_writer.h"
#include "components/record/recording/run_import.h"
#include "tests/components/record/logger/messages.h"
#include "tests/support/program.h"
#include "tests/support/skip.h"
#include "tests/support/temporary_folder.h"

namespace sinew {
namespace {

using testing::Finished;
using ::testing::HasSubstr;
using testing::Program;
using types::Signal;
using namespace std::chrono_literals;

const std::string kBin = std::string(SINEW_BIN_DIR) + "/";

const char kMap[] =
    "schema: sinew-csv-map/1\nkind: rotary\ntime: {column: t, unit: s}\nsignals:\n"
    "  position: {column: q, unit: rad}\n  motor_current: {column: i, unit: A}\n"
    "  reference_position: {column: r, unit: rad}\n";

std::string MakeCsv(int rows, double step_s) {
  std::string csv = "t,q,i,r\n";
  char line[160];
  for (int row = 0; row < rows; ++row) {
    std::snprintf(line, sizeof(line), "%.6f,%.17g,%.17g,%.17g\n", row * step_s,
                  std::sin(0.01 * row), 1.0 / (1.0 + row), std::cos(0.02 * row));
    csv += line;
  }
  return csv;
}

class LoggerDds : public ::testing::Test {
 protected:
  // Imports a CSV of so many rows; gives the recording's path.
  std::string Import(int rows, double step_s) {
    map_ = folder_.Write("map.yaml", kMap);
    csv_ = folder_.Write("data.csv", MakeCsv(rows, step_s));
    const std::string out = Path("imported.mcap");
    const Finished run =
        testing::Run({kBin + "sinew", "import", csv_, "--map", map_, "--out", out});
    EXPECT_EQ(run.exit_code, 0) << run.error;
    return out;
  }
  std::string Path(const std::string& name) const { return (folder_.path() / name).string(); }

  testing::TemporaryFolder folder_;
  std::string map_, csv_;
};

// Payloads of every topic but status and log, in the order of the file.
std::map<std::string, std::vector<std::string>> Payloads(const std::string& path) {
  recording::FileSource source(path);
  const recording::McapReader reader(source);
  EXPECT_FALSE(reader.recovery().has_value());
  std::map<std::string, std::vector<std::string>> payloads;
  recording::McapMessages messages = reader.Messages();
  recording::McapMessage message;
  while (messages.Next(&message)) {
    const std::string& topic = reader.channels().at(message.channel_id).topic;
    if (topic != "component_status" && topic != "log")
      payloads[topic].push_back(recording::Cursor::AsText(message.data));
  }
  return payloads;
}

TEST_F(LoggerDds, ReplayedRecordingIsTheSameAfterTheWire) {
  const std::string imported = Import(3000, 0.004);
  std::vector<std::string> copies;
  for (const std::string domain : {"20", "21"}) {
    const std::string copy = Path("copy" + domain + ".mcap");
    Program logger({kBin + "sinew-logger", "--lockstep", "--domain", domain, "--out", copy});
    Program player({kBin + "sinew-player", imported, "--lockstep", "--domain", domain, "--await",
                    "recording_progress:64", "--topics", "joint_state,actuator_state,reference"});
    EXPECT_EQ(player.Wait(60s), 0) << player.error();
    EXPECT_EQ(logger.Wait(20s), 0) << logger.error();
    copies.push_back(copy);
  }
  const types::Run expected = recording::ReadRuns(csv_, map_).at(0);
  const types::Run run = recording::ReadRuns(copies[0]).at(0);
  EXPECT_EQ(run.content_hash, expected.content_hash);
  ASSERT_EQ(run.size(), expected.size());
  for (Eigen::Index i = 0; i < run.size(); ++i) ASSERT_EQ(run.time_s[i], expected.time_s[i]) << i;
  for (const auto& [signal, values] : expected.signals) EXPECT_EQ(run.At(signal), values);
  // Two runs, one content.
  EXPECT_EQ(Payloads(copies[0]), Payloads(copies[1]));
  EXPECT_EQ(Payloads(copies[0]).at("joint_state").size(), 3000u);
}

TEST_F(LoggerDds, AKilledLoggerLosesAtMost200Milliseconds) {
  const std::string imported = Import(4000, 0.004);  // 16 s in real time
  const std::string copy = Path("killed.mcap");
  Program logger({kBin + "sinew-logger", "--domain", "22", "--out", copy});
  Program player({kBin + "sinew-player", imported, "--domain", "22", "--wait-readers", "1"});
  // Until the file holds a second of samples.
  const auto give_up = std::chrono::steady_clock::now() + 30s;
  std::uint64_t messages = 0;
  while (messages < 750 && std::chrono::steady_clock::now() < give_up) {
    try {
      recording::FileSource source(copy);
      messages = recording::McapReader(source).statistics().message_count;
    } catch (const std::exception&) {  // not there yet
    }
  }
  ASSERT_GE(messages, 750u) << logger.error() << player.error();
  const std::int64_t killed_ns = std::chrono::duration_cast<std::chrono::nanoseconds>(
                                     std::chrono::system_clock::now().time_since_epoch())
                                     .count();
  logger.Signal(SIGKILL);
  EXPECT_EQ(logger.Wait(10s), -SIGKILL);
  player.Signal(SIGINT);
  EXPECT_EQ(player.Wait(10s), 0) << player.error();

  recording::FileSource source(copy);
  const recording::McapReader reader(source);
  ASSERT_TRUE(reader.recovery().has_value());
  // 200 ms are promised; what a loaded test machine adds by not scheduling the logger is allowed
  // for.
  EXPECT_GT(reader.statistics().end_time_ns, killed_ns - 200'000'000 - 300'000'000);
  EXPECT_GE(recording::ReadRuns(copy).at(0).size(), 200);
}

TEST_F(LoggerDds, StopsCleanlyOnSignals) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const std::string out = Path("stopped" + std::to_string(signal) + ".mcap");
    Program logger(
        {kBin + "sinew-logger", "--domain", "23", "--out", out, "--note", "deployment=none"});
    // Its own status is the first message.
    ASSERT_TRUE(logger.WaitForText("domain 23", 10s));
    const auto give_up = std::chrono::steady_clock::now() + 10s;
    std::uint64_t messages = 0;
    while (messages == 0 && std::chrono::steady_clock::now() < give_up) {
      try {
        recording::FileSource source(out);
        messages = recording::McapReader(source).statistics().message_count;
      } catch (const std::exception&) {
      }
    }
    EXPECT_GT(messages, 0u);
    logger.Signal(signal);
    EXPECT_EQ(logger.Wait(10s), 0) << logger.error();
    recording::FileSource source(out);
    const recording::McapReader reader(source);
    EXPECT_FALSE(reader.recovery().has_value());
    const recording::McapMetadata metadata = reader.ReadMetadata().at(0);
    EXPECT_EQ(metadata.name, "sinew.recording");
    EXPECT_EQ(metadata.values.at("domain_id"), "23");
    EXPECT_EQ(metadata.values.at("deployment"), "none");
    EXPECT_EQ(metadata.values.at("topics_hash").size(), 8u);
  }
}

TEST_F(LoggerDds, AFullDiskEndsTheRecordingAtOnce) {
  SKIP_WITHOUT_KERNEL(std::filesystem::exists("/dev/full"), "/dev/full");
  const Finished run = testing::Run(
      {kBin + "sinew-logger", "--domain", "24", "--out", "/dev/full", "--overwrite"}, 20s);
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.error, HasSubstr("/dev/full: cannot be written: No space left on device"));
}

TEST_F(LoggerDds, WrongRequestsAreOneLineAndExitCode2) {
  const std::string imported = Import(20, 0.004);
  const std::string text = folder_.Write("text.mcap", "time_s,position\n");
  const auto expect = [](const std::vector<std::string>& arguments, const std::string& what) {
    const Finished run = testing::Run(arguments, 20s);
    EXPECT_EQ(run.exit_code, 2) << arguments[0] << " " << run.error;
    EXPECT_THAT(run.error, HasSubstr(what));
  };
  expect({kBin + "sinew-logger", "--domain", "24", "--out", imported}, "is there already");
  expect({kBin + "sinew-logger", "--domain", "24", "--out", Path("no/folder/x.mcap")},
         "cannot be written");
  expect({kBin + "sinew-logger", "--domain", "24", "--out", Path("x.mcap"), "--topics", "joints"},
         "no topic 'joints'");
  expect({kBin + "sinew-logger", "--domain", "24", "--out", Path("x.mcap"), "--note", "x"},
         "KEY=VALUE");
  EXPECT_FALSE(std::filesystem::exists(Path("x.mcap")));
  expect({kBin + "sinew-player", "--domain", "24", text}, "byte 0: no MCAP file");
  expect({kBin + "sinew-player", "--domain", "24", Path("absent.mcap")}, "cannot be read");
  expect({kBin + "sinew-player", "--domain", "24", imported, "--topics", "regime"},
         "'regime' is not in");
  expect({kBin + "sinew-player", "--domain", "24", imported, "--remap", "x"}, "expected FROM:TO");
  expect({kBin + "sinew-player", "--domain", "24", imported, "--await", "joint_command:500"},
         "from 0 to 128");
  expect({kBin + "sinew-player", "--domain", "24", imported, "--wait-readers", "1",
          "--wait-timeout", "0.5"},
         "readers of topic");
  expect({kBin + "sinew", "import", csv_, "--map", csv_, "--out", Path("y.mcap")}, csv_ + ":");
  expect({kBin + "sinew", "import", csv_, "--map", map_, "--out", imported}, "is there already");
  expect({kBin + "sinew", "echo", "joint_state", "--from", imported, "--field", "angle"},
         "no field 'angle'");
  expect({kBin + "sinew", "echo", "joints", "--domain", "24"}, "no topic 'joints'");
  expect({kBin + "sinew", "list", text}, "byte 0: no MCAP file");
}

TEST_F(LoggerDds, ThePlayerRefusesRecordingsOfOtherTypes) {
  const std::string path = Path("other.mcap");
  recording::TopicSchema schema = testing::SchemaOf("reference");
  const std::string from = "double velocity_rad_s[12]";
  schema.idl.replace(schema.idl.find(from), from.size(), "double speed_rad_s[12]");
  {
    recording::FileSink sink(path, recording::Existing::kReplace);
    recording::McapWriter writer(sink);
    recording::ChannelId channel{};
    ASSERT_TRUE(writer.Open().ok());
    ASSERT_TRUE(recording::AddTopic(schema, &writer, &channel).ok());
    ASSERT_TRUE(writer.WriteMessage(channel, 1, 1, testing::MakeMessage("reference", {})).ok());
    ASSERT_TRUE(writer.Close().ok());
  }
  const Finished run =
      testing::Run({kBin + "sinew-player", path, "--domain", "24", "--topics", "reference"}, 20s);
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.error, HasSubstr("topic 'reference' was recorded with another type"));
  const Finished unnamed = testing::Run({kBin + "sinew-player", path, "--domain", "24"}, 20s);
  EXPECT_EQ(unnamed.exit_code, 2);
  EXPECT_THAT(unnamed.error, HasSubstr("played when --topics names them"));
}

TEST_F(LoggerDds, APlayerStandsInForAComponentOfARunningSession) {
  const std::string imported = Import(600, 0.004);
  const std::string copy = Path("session.mcap");
  Program logger({kBin + "sinew-logger", "--lockstep", "--domain", "25", "--out", copy});
  Program stand_in({kBin + "sinew-player", imported, "--lockstep", "--domain", "25", "--topics",
                    "reference", "--name", "stand_in"});
  Program provider({kBin + "sinew-player", imported, "--lockstep", "--domain", "25", "--topics",
                    "joint_state,actuator_state", "--name", "provider", "--await",
                    "reference,recording_progress:64", "--wait-readers", "1"});
  EXPECT_EQ(provider.Wait(60s), 0) << provider.error();
  EXPECT_EQ(stand_in.Wait(20s), 0) << stand_in.error();
  EXPECT_EQ(logger.Wait(20s), 0) << logger.error();
  const types::Run run = recording::ReadRuns(copy).at(0);
  EXPECT_EQ(run.content_hash, recording::ReadRuns(csv_, map_).at(0).content_hash);
  EXPECT_EQ(Payloads(copy).at("reference").size(), 600u);
}

TEST_F(LoggerDds, ASecondStateProviderIsRefused) {
  const std::string imported = Import(4000, 0.004);
  Program first({kBin + "sinew-player", imported, "--domain", "26"});
  Program reader({kBin + "sinew", "echo", "joint_state", "--domain", "26", "-n", "1"});
  EXPECT_EQ(reader.Wait(20s), 0) << reader.error();  // the first one plays
  const Finished second = testing::Run({kBin + "sinew-player", imported, "--domain", "26"}, 20s);
  EXPECT_EQ(second.exit_code, 2);
  EXPECT_THAT(second.error, HasSubstr("already has a state provider: 'player'"));
  first.Signal(SIGINT);
  EXPECT_EQ(first.Wait(10s), 0);
}

TEST_F(LoggerDds, ListAndEchoShowWhatIsOnTheWire) {
  const std::string imported = Import(4000, 0.004);
  Program player({kBin + "sinew-player", imported, "--domain", "27"});
  Program echo({kBin + "sinew", "echo", "joint_state", "--domain", "27", "-n", "5", "--json",
                "--field", "header.tick", "--field", "position_rad[0]", "--field",
                "header.origin"});
  ASSERT_EQ(echo.Wait(20s), 0) << echo.error();
  std::istringstream lines(echo.output());
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) {
    const auto json = nlohmann::json::parse(line);
    EXPECT_EQ(json["header.origin"], "ORIGIN_REPLAY");
    EXPECT_EQ(json["position_rad[0]"].get<double>(),
              std::sin(0.01 * json["header.tick"].get<double>()));
  }
  EXPECT_EQ(count, 5);
  const Finished list = testing::Run({kBin + "sinew", "list", "--domain", "27", "--json"}, 20s);
  EXPECT_EQ(list.exit_code, 0) << list.output;
  const auto report = nlohmann::json::parse(list.output);
  EXPECT_EQ(report["domain"], 27);
  EXPECT_TRUE(report["problems"].empty());
  bool found = false;
  for (const auto& topic : report["topics"]) {
    if (topic["name"] != "joint_state") continue;
    found = true;
    EXPECT_EQ(topic["writers"], nlohmann::json::array({"player"}));
  }
  EXPECT_TRUE(found) << list.output;
  EXPECT_EQ(report["participants"][0]["name"], "player");
  EXPECT_EQ(report["participants"][0]["state"], "active");
  player.Signal(SIGINT);
  EXPECT_EQ(player.Wait(10s), 0);
  const Finished silent = testing::Run(
      {kBin + "sinew", "echo", "joint_state", "--domain", "28", "--timeout", "0.5"}, 20s);
  EXPECT_EQ(silent.exit_code, 1);
  EXPECT_THAT(silent.error, HasSubstr("nothing on 'joint_state' in domain 28"));
}

TEST_F(LoggerDds, RecordDoesWhatTheLoggerDoes) {
  const std::string imported = Import(1000, 0.004);
  const std::string copy = Path("recorded.mcap");
  Program record({kBin + "sinew", "record", "--lockstep", "--domain", "29", "--out", copy,
                  "--topics", "joint_state,reference", "--json"});
  Program replay({kBin + "sinew", "replay", imported, "--lockstep", "--domain", "29", "--json",
                  "--topics", "joint_state,reference"});
  EXPECT_EQ(replay.Wait(60s), 0) << replay.error();
  EXPECT_EQ(record.Wait(20s), 0) << record.error();
  EXPECT_EQ(nlohmann::json::parse(replay.output())["messages"], 2000);
  const auto result = nlohmann::json::parse(record.output());
  EXPECT_EQ(result["messages"], 2000);
  EXPECT_EQ(result["missing_ticks"], 0);
  EXPECT_EQ(result["end"], "session ended");
  EXPECT_EQ(recording::ReadRuns(copy).at(0).size(), 1000);
}

// Measured data of another rig: straight from its CSV files, and imported, replayed over DDS and
// recorded.
TEST_F(LoggerDds, ClosingTheLoopOnARecordingGivesTheFiguresOfTheFilesItCameFrom) {
  const std::filesystem::path data = std::filesystem::path(SINEW_SHARED_DIR) / "data/emps";
  SKIP_WITHOUT_DATA(data);
  const std::string robot = std::string(SINEW_SOURCE_DIR) + "/robots/emps/";
  std::vector<std::string> csv, copies;
  for (const std::string name : {"DATA_EMPS", "DATA_EMPS_PULSES"}) {
    csv.push_back((data / (name + ".csv")).string());
    const std::string imported = Path(name + "_imported.mcap");
    copies.push_back(Path(name + ".mcap"));
    const Finished import = testing::Run(
        {kBin + "sinew", "import", csv.back(), "--map", robot + "csv_map.yaml", "--out", imported});
    ASSERT_EQ(import.exit_code, 0) << import.error;
    Program logger({kBin + "sinew-logger", "--lockstep", "--domain", "30", "--out", copies.back()});
    Program replay({kBin + "sinew", "replay", imported, "--lockstep", "--domain", "30"});
    ASSERT_EQ(replay.Wait(90s), 0) << replay.error();
    ASSERT_EQ(logger.Wait(30s), 0) << logger.error();
  }
  const auto close_loop = [&](const std::vector<std::string>& files, const std::string& out) {
    const Finished run = testing::Run(
        {kBin + "sinew", "close-loop", "--model", robot + "model.yaml", "--map",
         robot + "csv_map.yaml", "--train", files[0], "--held-out", files[1], "--out", Path(out)},
        120s);
    EXPECT_EQ(run.exit_code, 0) << run.error;
    return nlohmann::json::parse(config::ReadFile(Path(out) + "/report.json"));
  };
  const nlohmann::json expected = close_loop(csv, "from_csv");
  const nlohmann::json report = close_loop(copies, "from_recording");
  for (const char* key : {"verdict", "effects", "held_out", "train", "as_published"}) {
    EXPECT_TRUE(expected.contains(key)) << key;
    EXPECT_EQ(report[key], expected[key]) << key;
  }
}

}  // namespace
}  // namespace sinew
