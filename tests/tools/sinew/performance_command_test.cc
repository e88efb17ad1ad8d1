// `sinew performance` on recordings whose figures are known by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sinew_idl/actuator.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/reference.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "components/base/config/config.h"
#include "components/model/report/file/section_file.h"
#include "components/record/recording/file/file_io.h"
#include "components/record/recording/mcap_writer.h"
#include "components/record/recording/run_import.h"
#include "components/topics/node/codec.h"
#include "components/topics/node/topics.h"
#include "tests/support/temporary_folder.h"
#include "tools/sinew/commands.h"

namespace sinew::tools {
namespace {

using ::testing::HasSubstr;

const std::string kRigPerformance = SINEW_SOURCE_DIR "/robots/rig/performance.yaml";
constexpr int kTicks = 4800, kRate_Hz = 240;
constexpr int kBumpBegin = 1200, kBumpEnd = 1440;  // ticks
constexpr double kUsualError_rad = 0.02, kBumpError_rad = 0.32;

double ErrorAt_rad(int tick) {
  return tick >= kBumpBegin && tick < kBumpEnd ? kBumpError_rad : kUsualError_rad;
}

class Recorder {
 public:
  explicit Recorder(const std::string& path) : sink_(path, recording::Existing::kReplace) {
    EXPECT_TRUE(writer_.Open().ok());
  }
  template <class Message>
  recording::ChannelId AddChannel(const node::Topic<Message>& topic, bool foreign = false) {
    const node::TopicInfo& info = *node::FindTopic(topic.name);
    const recording::TopicSchema schema{info.name, info.type_name, info.idl,
                                        foreign ? "00000000" : info.idl_hash};
    recording::ChannelId id{};
    EXPECT_TRUE(recording::AddTopic(schema, &writer_, &id).ok());
    return id;
  }
  template <class Message>
  void Write(recording::ChannelId channel, const Message& message) {
    node::Bytes bytes;
    EXPECT_TRUE(node::Encode(message, &bytes));
    const std::int64_t stamp_ns = message.header.stamp_ns;
    EXPECT_TRUE(writer_.WriteMessage(channel, stamp_ns, stamp_ns, bytes).ok());
  }
  void Close() { EXPECT_TRUE(writer_.Close().ok() && sink_.Close().ok()); }

 private:
  recording::FileSink sink_;
  recording::McapWriter writer_{sink_};
};

// 20 s of the rig at 1 rad/s under 2 N m and 1 A, behind its reference by ErrorAt_rad.
std::string WriteRun(const testing::TemporaryFolder& folder, int sessions = 1,
                     bool foreign_reference = false) {
  const std::string path = (folder.path() / "run.mcap").string();
  Recorder recorder(path);
  const auto states = recorder.AddChannel(node::kJointState);
  const auto references = recorder.AddChannel(node::kReference, foreign_reference);
  const auto actuators = recorder.AddChannel(node::kActuatorState);
  for (int session = 1; session <= sessions; ++session) {
    for (int tick = 0; tick < kTicks; ++tick) {
      msg::JointState state;
      state.header.session_id = static_cast<std::uint64_t>(session);
      state.header.tick = static_cast<std::uint64_t>(tick);
      state.header.stamp_ns = (std::int64_t{kTicks} * session + tick) * 4'166'667;
      state.period_s = 1.0 / kRate_Hz;
      state.joint_count = 1;
      state.valid[0] = true;
      state.velocity_rad_s[0] = 1.0;
      state.torque_Nm[0] = 2.0;
      msg::Reference reference;
      reference.header = state.header;
      reference.joint_count = 1;
      reference.position_rad[0] = ErrorAt_rad(tick);
      msg::ActuatorState actuator;
      actuator.header = state.header;
      actuator.joint_count = 1;
      actuator.valid[0] = true;
      actuator.motor_current_A[0] = 1.0;
      recorder.Write(references, reference);  // the order in a file is that of arrival
      recorder.Write(states, state);
      recorder.Write(actuators, actuator);
    }
  }
  recorder.Close();
  return path;
}

// What it prints.
std::string Performance(std::vector<std::string> arguments) {
  CLI::App app("sinew");
  AddPerformanceCommand(app);
  arguments.insert(arguments.begin(), "performance");
  std::reverse(arguments.begin(), arguments.end());
  ::testing::internal::CaptureStdout();
  try {
    app.parse(arguments);
  } catch (...) {
    (void)::testing::internal::GetCapturedStdout();
    throw;
  }
  return ::testing::internal::GetCapturedStdout();
}

TEST(PerformanceCommand, GivesTheFiguresOfARecording) {
  const testing::TemporaryFolder folder;
  const nlohmann::json report = nlohmann::json::parse(
      Performance({WriteRun(folder), "--config", kRigPerformance, "--event", "5", "--json"}));
  ASSERT_EQ(report.size(), 1u);
  const nlohmann::json& joint = report[0].at("joints").at(0);
  const double bump = static_cast<double>(kBumpEnd - kBumpBegin) / kTicks;
  const double mse_rad2 =
      bump * std::pow(kBumpError_rad, 2) + (1.0 - bump) * std::pow(kUsualError_rad, 2);
  EXPECT_NEAR(joint.at("mean_square_error_rad2").get<double>(), mse_rad2, 1e-12);
  EXPECT_EQ(joint.at("error_samples"), kTicks);
  EXPECT_NEAR(joint.at("sliding_rms_rad").get<double>(), kUsualError_rad, 1e-12);
  const double duration_s = static_cast<double>(kTicks - 1) / kRate_Hz;
  EXPECT_NEAR(joint.at("positive_work_J").get<double>(), 2.0 * duration_s, 1e-9);
  // R I^2 + Kt I N w of performance.yaml and its model: 0.18 Ohm, 600 rpm/V, 100:1.
  EXPECT_NEAR(report[0].at("robot").at("electrical_J").get<double>(),
              (0.18 + 100.0 * 60.0 / (2.0 * M_PI * 600.0)) * duration_s, 1e-3);
  EXPECT_FALSE(report[0].at("robot").contains("lifting_work_J"));
  // With one sample of the bump left in the window of 361 the RMSE is 0.026 rad, with two 0.031:
  // within 0.01 of 0.02 from the tick on at which only the last one is left.
  EXPECT_NEAR(joint.at("settle_s").get<double>(),
              static_cast<double>(kBumpEnd - 1 + 360 - kBumpBegin) / kRate_Hz, 1e-9);
  EXPECT_NEAR(joint.at("plateau_rad").get<double>(), kUsualError_rad, 1e-3);
}

TEST(PerformanceCommand, WritesTableCurveAndSection) {
  const testing::TemporaryFolder folder;
  const std::string csv = (folder.path() / "rms.csv").string();
  const std::filesystem::path out = folder.path() / "section";
  const std::string text = Performance(
      {WriteRun(folder), "--config", kRigPerformance, "--csv", csv, "--out", out.string()});
  EXPECT_THAT(text, HasSubstr("sliding RMSE"));
  EXPECT_THAT(text, HasSubstr("robot"));
  std::ifstream lines(csv);
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "time_s,joint_rad");
  int rows = 0;
  while (std::getline(lines, line)) ++rows;
  EXPECT_EQ(rows, kTicks);
  const report::Section section = report::ReadSection(out);
  ASSERT_EQ(section.tables.size(), 1u);
  EXPECT_EQ(section.tables[0].rows.size(), 2u);
  EXPECT_EQ(section.svgs.size(), 1u);
}

TEST(PerformanceCommand, KeepsSessionsApart) {
  const testing::TemporaryFolder folder;
  const std::string run = WriteRun(folder, 2);
  const nlohmann::json report =
      nlohmann::json::parse(Performance({run, "--config", kRigPerformance, "--json"}));
  ASSERT_EQ(report.size(), 2u);
  EXPECT_EQ(report[0].at("joints"), report[1].at("joints"));
  EXPECT_THROW(Performance({run, "--config", kRigPerformance, "--csv", "x.csv"}), UsageError);
}

TEST(PerformanceCommand, RefusesWhatItCannotRead) {
  const testing::TemporaryFolder folder;
  EXPECT_THROW(Performance({"no.mcap", "--config", kRigPerformance}), UsageError);
  EXPECT_THROW(Performance({WriteRun(folder), "--config", "no.yaml"}), UsageError);
  EXPECT_THROW(Performance({WriteRun(folder), "--config",
                            SINEW_SOURCE_DIR "/robots/biped/performance.yaml"}),
               UsageError);  // twelve joints
  try {
    Performance({WriteRun(folder, 1, true), "--config", kRigPerformance});
    ADD_FAILURE() << "accepted a reference of other fields";
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr("00000000"));
  }
}

}  // namespace
}  // namespace sinew::tools
