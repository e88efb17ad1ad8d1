// `sinew rerun` from the command line, on a recording of two seconds.
#include "tools/rerun/command.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "bench/rerun/rig_recording.h"
#include "components/base/config/config.h"
#include "tests/support/temporary_folder.h"

namespace sinew::rerun {
namespace {

struct CommandResult {
  int exit_code = 0;
  std::string output, error;  // error: of a request that was wrong
};

CommandResult RunRerun(std::vector<std::string> arguments) {
  CLI::App app;
  AddRerunCommand(app);
  arguments.insert(arguments.begin(), "rerun");
  std::reverse(arguments.begin(), arguments.end());  // as CLI11 takes a vector
  CommandResult result;
  ::testing::internal::CaptureStdout();
  try {
    app.parse(arguments);
  } catch (const CLI::RuntimeError& error) {
    result.exit_code = error.get_exit_code();
  } catch (const UsageError& error) {
    result.exit_code = 2;
    result.error = error.what();
  }
  result.output = ::testing::internal::GetCapturedStdout();
  return result;
}

// A recording, and its deployment with programs that are never started.
class RerunCommand : public ::testing::Test {
 protected:
  RerunCommand() {
    RecordRig({.rig = kRigOfCommand, .out = recording_, .ticks = 480});
    std::string text = "schema: sinew-deployment/1\nname: rig\nprocesses:\n";
    for (const compose::Part& part : PartsOfTheRig(kRigOfCommand)) {
      const std::filesystem::path program = folder_.Write(part.program, "");
      std::filesystem::permissions(program, std::filesystem::perms::owner_all);
      text += "  - {name: " + part.name + ", program: ./" + part.program +
              ", config: " + part.config.string() + "}\n";
    }
    deployment_ = folder_.Write("deploy.yaml", text);
  }

  const std::filesystem::path kRigOfCommand = SINEW_SOURCE_DIR "/robots/rig";
  testing::TemporaryFolder folder_;
  const std::string recording_ = (folder_.path() / "run.mcap").string();
  std::string deployment_;
};

TEST_F(RerunCommand, SaysIdenticalOfEachComponent) {
  const CommandResult result = RunRerun({recording_, "--deployment", deployment_});
  EXPECT_EQ(result.exit_code, 0) << result.output << result.error;
  EXPECT_NE(result.output.find("run.mcap: session 1 of 1, lockstep, 2.0 s run again in "),
            std::string::npos)
      << result.output;
  for (const char* line : {"pneumatics: identical; 960 messages of 480 ticks compared",
                           "reference: identical; 480 messages of 480 ticks compared",
                           "control: identical; 480 messages of 480 ticks compared"}) {
    EXPECT_NE(result.output.find(line), std::string::npos) << result.output;
  }
}

TEST_F(RerunCommand, SaysWhatAnotherConfigurationDoesFirst) {
  const CommandResult result =
      RunRerun({recording_, "--deployment", deployment_, "--component", "control", "--set",
                "control.config=" + (kRigOfCommand / "control_pid_model.yaml").string()});
  EXPECT_EQ(result.exit_code, 1) << result.error;
  EXPECT_NE(result.output.find("control: differs at tick "), std::string::npos) << result.output;
  EXPECT_NE(result.output.find(": joint_command."), std::string::npos) << result.output;
}

TEST_F(RerunCommand, FromASnapshotInJson) {
  const CommandResult result = RunRerun(
      {recording_, "--deployment", deployment_, "--component", "esn,rls", "--from", "1", "--json"});
  EXPECT_EQ(result.exit_code, 0) << result.output << result.error;
  EXPECT_NE(result.output.find("\"identical\": true"), std::string::npos) << result.output;
  EXPECT_NE(result.output.find("\"ticks\": 479"), std::string::npos) << result.output;
}

TEST_F(RerunCommand, ShowsWhatOtherValuesWouldHaveDone) {
  const std::string picture = (folder_.path() / "torque.png").string();
  const CommandResult result = RunRerun({recording_, "--deployment", deployment_, "--with",
                                         "control.proportional_Nm_rad=3", "--png", picture});
  EXPECT_EQ(result.exit_code, 1) << result.error;
  EXPECT_NE(result.output.find("control: differs at tick "), std::string::npos) << result.output;
  EXPECT_NE(result.output.find("joint_command.motor_torque_Nm[0]: in "), std::string::npos)
      << result.output;
  EXPECT_EQ(result.output.find("pneumatics"), std::string::npos) << "it has no such entry";
  EXPECT_EQ(config::ReadFile(picture).substr(1, 3), "PNG");
}

// The model that is there, by another name: rls and control read it, and do what they did.
TEST_F(RerunCommand, AnotherFileOfTheSameContentIsIdentical) {
  const std::string model =
      folder_.Write("found.yaml", config::ReadFile(kRigOfCommand / "surrogate_model.yaml"));
  std::filesystem::copy_file(kRigOfCommand / "rig.urdf", folder_.path() / "rig.urdf");
  const CommandResult result = RunRerun(
      {recording_, "--deployment", deployment_, "--with", "model=" + model, "--field",
       "joint_command.motor_torque_Nm[0]", "--png", (folder_.path() / "same.png").string()});
  EXPECT_EQ(result.exit_code, 0) << result.output << result.error;
  EXPECT_NE(result.output.find("control: identical"), std::string::npos) << result.output;
  EXPECT_NE(result.output.find("rls: identical"), std::string::npos) << result.output;
}

TEST_F(RerunCommand, AWrongEditOrFieldIsNamed) {
  const auto error_of = [&](const char* option, const char* text) {
    return RunRerun({recording_, "--deployment", deployment_, option, text}).error;
  };
  EXPECT_EQ(error_of("--with", "model"), "--with model: expected KEY=VALUE or COMPONENT.KEY=VALUE");
  EXPECT_EQ(error_of("--with", "no_such_entry=1"),
            "--with no_such_entry: no configuration has such an entry, expected a key that is "
            "written there");
  EXPECT_NE(error_of("--with", "control.model=absent.yaml").find("absent.yaml"), std::string::npos);
  EXPECT_EQ(error_of("--field", "joint_command.no_such").find("topic 'joint_command': "), 0u);
  EXPECT_EQ(error_of("--field", "joint_state.velocity_rad_s[0]"),
            "topic 'joint_state': no component that is run again writes it");
}

TEST_F(RerunCommand, AWrongRequestNamesFileAndWhatWasExpected) {
  EXPECT_EQ(RunRerun({recording_}).error,
            recording_ + ": no deployment is attached, expected --deployment FILE");
  EXPECT_EQ(RunRerun({recording_, "--deployment", deployment_, "--session", "2"}).error,
            recording_ + ": session 2, expected 1 to 1");
  const std::string no_recording = folder_.Write("not.mcap", "text");
  EXPECT_EQ(RunRerun({no_recording, "--deployment", deployment_}).error.find(no_recording), 0u);
}

}  // namespace
}  // namespace sinew::rerun
