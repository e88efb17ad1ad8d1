// `sinew plot`, and what `sinew echo`, `sinew hz` and `sinew list` print of a recording.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "components/base/config/config.h"
#include "components/record/recording/file/file_io.h"
#include "components/record/recording/mcap_writer.h"
#include "tests/components/record/logger/messages.h"
#include "tests/support/program.h"
#include "tests/support/sinew_program.h"
#include "tests/support/temporary_folder.h"

namespace sinew {
namespace {

using sinew::testing::Finished;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

// Two sessions in lockstep of 1 s each at 100 Hz, whose stamps both begin at 0: two joints, the
// first a sine of 1 Hz (0.3 s of it lost), the second still. The reference begins after 0.5 s.
class RecordedPlot : public ::testing::Test {
 protected:
  void SetUp() override {
    recording::FileSink sink(path_, recording::Existing::kReplace);
    recording::McapWriter writer(sink);
    ASSERT_TRUE(writer.Open().ok());
    std::map<std::string, recording::ChannelId> channels;
    for (const char* topic : {"joint_state", "reference", "component_status"}) {
      ASSERT_TRUE(recording::AddTopic(testing::SchemaOf(topic), &writer, &channels[topic]).ok());
    }
    std::int64_t log_ns = 1'700'000'000'000'000'000;
    for (int session = 1; session <= 2; ++session) {
      for (int tick = 0; tick < 100; ++tick, log_ns += 1'000'000) {
        const std::int64_t stamp_ns = 10'000'000LL * tick;
        const double angle = tick < 60 || tick >= 90 ? std::sin(0.02 * M_PI * tick) : std::nan("");
        std::map<std::string, double> fields = {
            {"header.session_id", session},  {"header.tick", tick},
            {"header.stamp_ns", 1e7 * tick}, {"joint_count", 2},
            {"position_rad[0]", angle},      {"torque_Nm[0]", 3.0}};
        ASSERT_TRUE(writer
                        .WriteMessage(channels["joint_state"], log_ns, stamp_ns,
                                      testing::MakeMessage("joint_state", fields))
                        .ok());
        if (tick < 50) continue;
        fields.erase("torque_Nm[0]");
        ASSERT_TRUE(writer
                        .WriteMessage(channels["reference"], log_ns, stamp_ns,
                                      testing::MakeMessage("reference", fields))
                        .ok());
      }
    }
    ASSERT_TRUE(writer
                    .WriteMessage(channels["component_status"], log_ns, 0,
                                  testing::MakeMessage("component_status", {}))
                    .ok());
    ASSERT_TRUE(writer.Close().ok() && sink.Close().ok());
  }

  // In the terminal, of which there is none.
  Finished Plot(std::vector<std::string> words) const {
    words.insert(words.begin(), {kSinew, "plot", path_.string()});
    return testing::Run(words);
  }
  Finished Echo(std::vector<std::string> words) const {
    words.insert(words.begin(), {kSinew, "echo"});
    words.insert(words.end(), {"--from", path_.string()});
    return testing::Run(words);
  }

  testing::TemporaryFolder folder_;
  const std::filesystem::path path_ = folder_.path() / "run.mcap";
};

TEST_F(RecordedPlot, AllJointsAreDrawnOverBothSessionsWithTheUnit) {
  const Finished run = Plot({"joint_state.position_rad"});
  ASSERT_EQ(run.exit_code, 0) << run.error;
  EXPECT_THAT(run.output, AllOf(HasSubstr("position, rad   \u28ff joint_state.position_rad[0]"),
                                HasSubstr("\u28ff joint_state.position_rad[1]"),
                                Not(HasSubstr("position_rad[2]")), Not(HasSubstr("\x1b"))));
  // Simulated time: 2 s, and not the 0.2 s of the log.
  EXPECT_THAT(run.output, ::testing::ContainsRegex("\n +0 .* 1\\.8 *\n"));
}

TEST_F(RecordedPlot, TimeBeginsWithTheRecordingAndFromToCut) {
  const Finished late = Plot({"reference.position_rad[0]", "--to", "0.905"});
  ASSERT_EQ(late.exit_code, 0) << late.error;
  EXPECT_THAT(late.output, ::testing::ContainsRegex("\n +0\\.5 .* 0\\.9 *\n"));
  const Finished cut = Plot({"joint_state.position_rad[0]", "--from", "1.195", "--to", "1.405"});
  ASSERT_EQ(cut.exit_code, 0) << cut.error;
  EXPECT_THAT(cut.output, ::testing::ContainsRegex("\n +1\\.2 .* 1\\.4 *\n"));
  const Finished none = Plot({"joint_state.position_rad[0]", "--from", "30"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.error, HasSubstr("between --from and --to"));
}

TEST_F(RecordedPlot, WidthAndHeightAreThoseOfTheDrawing) {
  const Finished run = Plot({"joint_state.position_rad[0]", "--width", "50", "--height", "15"});
  ASSERT_EQ(run.exit_code, 0) << run.error;
  EXPECT_EQ(std::count(run.output.begin(), run.output.end(), '\n'), 15);
  std::istringstream lines(run.output);
  for (std::string line; std::getline(lines, line);) {
    const auto characters =
        std::count_if(line.begin(), line.end(), [](char c) { return (c & 0xc0) != 0x80; });
    EXPECT_LE(characters, 50) << line;
  }
}

TEST_F(RecordedPlot, PicturesAreWrittenAsPngAndSvg) {
  const std::string png = folder_.path() / "q.png", svg = folder_.path() / "q.svg";
  const Finished run = Plot({"joint_state.position_rad[0]", "joint_state.torque_Nm[0]", "--png",
                             png, "--svg", svg, "--width", "640", "--height", "480"});
  ASSERT_EQ(run.exit_code, 0) << run.error;
  EXPECT_EQ(run.output, "");
  EXPECT_THAT(config::ReadFile(png), StartsWith("\x89PNG"));
  const std::string drawn = config::ReadFile(svg);
  for (const char* part : {"width=\"640\" height=\"480\"", "position, rad", "torque, Nm", "time, s",
                           "joint_state.position_rad[0]"}) {
    EXPECT_THAT(drawn, HasSubstr(part));
  }
}

TEST_F(RecordedPlot, SeveralRecordingsAreNamed) {
  const Finished run = Plot({path_.string(), "joint_state.torque_Nm[0]", "--width", "200"});
  ASSERT_EQ(run.exit_code, 0) << run.error;
  EXPECT_THAT(run.output, HasSubstr("run.mcap: joint_state.torque_Nm[0]"));
}

TEST_F(RecordedPlot, WhatIsNotThereIsOneLineThatNamesWhatIs) {
  const struct {
    std::vector<std::string> words;
    std::vector<const char*> parts;
  } kCases[] = {
      {{"joint_stat.position_rad[0]"},
       {"no topic 'joint_stat', expected one of: component_status, joint_state, reference",
        "did you mean 'joint_state'?"}},
      {{"joint_state.positon_rad[0]"},
       {"joint_state: no field 'positon_rad[0]'", "header.tick", "did you mean 'position_rad'?"}},
      {{"joint_state.position_rad[2]"}, {"expected one of: position_rad[0], position_rad[1]"}},
      {{"joint_state"}, {"'joint_state': expected TOPIC.FIELD"}},
      {{}, {"no field, expected TOPIC.FIELD"}}};
  for (const auto& one : kCases) {
    const Finished run = Plot(one.words);
    EXPECT_EQ(run.exit_code, 2) << run.error;
    EXPECT_EQ(std::count(run.error.begin(), run.error.end(), '\n'), 1) << run.error;
    for (const char* part : one.parts) EXPECT_THAT(run.error, HasSubstr(part));
  }
  const std::string text = folder_.Write("text.mcap", "no recording");
  const Finished broken = testing::Run({kSinew, "plot", text, "joint_state.position_rad[0]"});
  EXPECT_EQ(broken.exit_code, 2);
  EXPECT_THAT(broken.error, HasSubstr("byte 0: no MCAP file"));
}

TEST_F(RecordedPlot, EchoPrintsOneFieldOfATopic) {
  const Finished one = Echo({"joint_state.torque_Nm[0]", "-n", "2"});
  ASSERT_EQ(one.exit_code, 0) << one.error;
  EXPECT_EQ(one.output, "3.0\n3.0\n");
  const Finished joints = Echo({"joint_state.torque_Nm", "--once"});
  ASSERT_EQ(joints.exit_code, 0) << joints.error;
  EXPECT_EQ(joints.output, "[3.0,0.0]\n") << "the two joints";
  const Finished json =
      Echo({"joint_state.torque_Nm", "--field", "header.tick", "--once", "--json"});
  EXPECT_EQ(json.output, "{\"torque_Nm\":[3.0,0.0],\"header.tick\":0}\n");
}

// 2 s of simulated time: 0, 0.25, 0.5, 0.75 s of each session.
TEST_F(RecordedPlot, EchoPrintsAtMostAtTheRate) {
  const Finished run = Echo({"joint_state.header.tick", "--rate", "4"});
  ASSERT_EQ(run.exit_code, 0) << run.error;
  EXPECT_EQ(run.output, "0\n25\n50\n75\n0\n25\n50\n75\n");
}

TEST_F(RecordedPlot, ARecordingIsAPositionAndFromToAreItsTime) {
  const std::string file = path_.string();
  const Finished echo = testing::Run(
      {kSinew, "echo", "joint_state.header.tick", file, "--from", "0.985", "--to", "1.005"});
  ASSERT_EQ(echo.exit_code, 0) << echo.error;
  EXPECT_EQ(echo.output, "99\n0\n1\n") << "the second session follows the first";
  EXPECT_EQ(echo.error, "");
  const Finished hz =
      testing::Run({kSinew, "hz", "reference", file, "--from", "0.3", "--to", "0.605", "--json"});
  ASSERT_EQ(hz.exit_code, 0) << hz.error;
  EXPECT_THAT(hz.output, AllOf(HasSubstr("\"messages\":11"), Not(HasSubstr("joint_state"))));
  const Finished former = testing::Run({kSinew, "hz", "--from", file});
  EXPECT_EQ(former.exit_code, 0) << former.error;
  EXPECT_THAT(former.error, HasSubstr("`sinew hz FILE.mcap`"));
  const Finished none = testing::Run({kSinew, "hz", "joint_state", "--from", "1"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.error, HasSubstr("times of a recording"));
}

TEST_F(RecordedPlot, EchoRefusesWhatIsNotThere) {
  const Finished field = Echo({"joint_state.angle"});
  EXPECT_EQ(field.exit_code, 2);
  EXPECT_THAT(field.error, HasSubstr("no field 'angle'"));
  const Finished topic = Echo({"refrence", "--once"});
  EXPECT_EQ(topic.exit_code, 2);
  EXPECT_THAT(topic.error, HasSubstr("did you mean 'reference'?"));
}

TEST_F(RecordedPlot, ListShowsTheTopicsOfTheRobotAndWithAllEverything) {
  const Finished list = testing::Run({kSinew, "list", path_.string()});
  ASSERT_EQ(list.exit_code, 0) << list.error;
  EXPECT_THAT(list.output,
              AllOf(HasSubstr("run.mcap: 301 messages, "),
                    HasSubstr(" MB, 2.0 s\n"),  // simulated; the log has 0.2 s
                    HasSubstr("\njoint_state                 200  JointState         \n"),
                    HasSubstr("\nreference                   100  Reference          \n"),
                    HasSubstr("\nnot shown without --all: component_status\n")));
  EXPECT_LE(std::count(list.output.begin(), list.output.end(), '\n'), 20);
  const Finished all = testing::Run({kSinew, "list", path_.string(), "--all"});
  ASSERT_EQ(all.exit_code, 0) << all.error;
  EXPECT_THAT(all.output, AllOf(HasSubstr("\ncomponent_status "), HasSubstr("sinew::msg::Ref"),
                                Not(HasSubstr("not shown"))));
}

TEST_F(RecordedPlot, HzOfLockstepIsThatOfSimulatedTime) {
  const Finished hz = testing::Run({kSinew, "hz", "--from", path_.string(), "--json"});
  ASSERT_EQ(hz.exit_code, 0) << hz.error;
  const auto rows = nlohmann::json::parse(hz.output);
  for (const auto& row : rows) {
    if (row["topic"] != "joint_state") continue;
    EXPECT_NEAR(row["rate_Hz"].get<double>(), 100.0, 1.0);
    EXPECT_NEAR(row["seconds"].get<double>(), 1.98, 1e-9);
    EXPECT_TRUE(row["age_ms"].is_null());
    return;
  }
  FAIL() << hz.output;
}

// A live robot at 100 Hz whose clock was set back by 0.25 s at tick 50.
TEST_F(RecordedPlot, TicksAndTimeGoOnWhereTheClockWasSetBack) {
  const std::filesystem::path path = folder_.path() / "set_back.mcap";
  recording::FileSink sink(path, recording::Existing::kReplace);
  recording::McapWriter writer(sink);
  recording::ChannelId channel{};
  ASSERT_TRUE(writer.Open().ok());
  ASSERT_TRUE(recording::AddTopic(testing::SchemaOf("joint_state"), &writer, &channel).ok());
  std::string ticks;
  for (int tick = 0; tick < 100; ++tick) {
    ticks += std::to_string(tick) + "\n";
    const std::int64_t stamp_ns =
        1'700'000'000'000'000'000 + 10'000'000LL * tick - (tick < 50 ? 0 : 250'000'000);
    ASSERT_TRUE(
        writer
            .WriteMessage(channel, stamp_ns + 1000, stamp_ns,
                          testing::MakeMessage("joint_state", {{"header.session_id", 1},
                                                               {"header.tick", double(tick)}}))
            .ok());
  }
  ASSERT_TRUE(writer.Close().ok() && sink.Close().ok());
  const Finished echo =
      testing::Run({kSinew, "echo", "joint_state.header.tick", "--from", path.string()});
  EXPECT_EQ(echo.output, ticks) << echo.error;
  const Finished hz = testing::Run({kSinew, "hz", "--from", path.string(), "--json"});
  ASSERT_EQ(hz.exit_code, 0) << hz.error;
  const auto row = nlohmann::json::parse(hz.output).at(0);
  EXPECT_NEAR(row["rate_Hz"].get<double>(), 100.0, 1e-6);
  EXPECT_EQ(row["repeated"], 0);
  EXPECT_EQ(row["lost"], 0);
  const Finished list = testing::Run({kSinew, "list", path.string(), "--json"});
  EXPECT_NEAR(nlohmann::json::parse(list.output)["duration_s"].get<double>(), 0.99, 1e-9);
}

// Every command leaves them out with the same words; a known name does not matter.
TEST_F(RecordedPlot, TopicsThatNobodyReadsAreLeftOutWithOneWarning) {
  const std::filesystem::path path = folder_.path() / "foreign.mcap";
  recording::FileSink sink(path, recording::Existing::kReplace);
  recording::McapWriter writer(sink);
  recording::ChannelId joint{}, status{}, note{};
  ASSERT_TRUE(writer.Open().ok());
  const recording::TopicSchema known = testing::SchemaOf("joint_state");
  recording::SchemaId schema{};
  ASSERT_TRUE(writer.AddSchema(known.type_name, "omgidl", known.idl, &schema).ok());
  ASSERT_TRUE(
      writer.AddChannel(schema, "joint_state", "cdr", {{"participant", "rig"}}, &joint).ok());
  ASSERT_TRUE(
      writer.AddChannel(recording::SchemaId{}, "component_status", "json", {}, &status).ok());
  ASSERT_TRUE(writer.AddChannel(recording::SchemaId{}, "note", "json", {}, &note).ok());
  ASSERT_TRUE(writer.WriteMessage(joint, 1000, 0, testing::MakeMessage("joint_state", {})).ok());
  ASSERT_TRUE(writer.WriteMessage(status, 2000, 0, recording::Bytes(2)).ok());
  ASSERT_TRUE(writer.Close().ok() && sink.Close().ok());
  const std::string expected =
      path.string() +
      ": left out: topic 'component_status' has messages 'json' with no schema, expected 'cdr' "
      "with 'omgidl'; topic 'note' has messages 'json' with no schema, expected 'cdr' with "
      "'omgidl'\n";
  const std::string file = path.string(), out = (folder_.path() / "out").string();
  for (const std::vector<std::string>& command :
       std::vector<std::vector<std::string>>{{"list", file},
                                             {"export", file, "--format", "csv", "--out", out},
                                             {"graph", file, "--out", out + ".dot"}}) {
    std::vector<std::string> words = {kSinew};
    words.insert(words.end(), command.begin(), command.end());
    const Finished run = testing::Run(words);
    EXPECT_EQ(run.exit_code, 0) << command[0];
    EXPECT_EQ(run.error, expected) << command[0];
  }
  // It has nothing to run again, which it says after the warning.
  const Finished rerun = testing::Run({kSinew, "rerun", file});
  EXPECT_EQ(rerun.exit_code, 2);
  EXPECT_THAT(rerun.error, StartsWith(expected));
}

}  // namespace
}  // namespace sinew
