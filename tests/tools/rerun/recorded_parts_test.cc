// Which components a recording is run again with.
#include "tools/rerun/recorded_parts.h"

#include <gtest/gtest.h>
#include <sinew_idl/joint.h>

#include <string>

#include "components/base/config/config.h"
#include "components/record/recording/file/file_io.h"
#include "components/record/recording/mcap_writer.h"
#include "components/record/recording/run_import.h"
#include "components/topics/node/topics.h"
#include "tests/support/temporary_folder.h"
#include "tools/rerun/recorded_ticks.h"

namespace sinew::rerun {
namespace {

using testing::TemporaryFolder;

launch::Deployment SomeDeployment() {
  launch::Deployment deployment;
  deployment.file = "deploy.yaml";
  for (const char* name : {"surrogate", "regime", "control", "logger"}) {
    launch::Process process;
    process.name = name;
    process.program = "/bin/sinew-" + process.name;
    process.config = process.name + ".yaml";
    deployment.processes.push_back(process);
  }
  return deployment;
}

std::string UsageErrorOf(const std::function<void()>& work) {
  try {
    work();
  } catch (const UsageError& error) {
    return error.what();
  }
  return "no error";
}

// A recording of nothing but attachments and metadata.
class AttachedFiles {
 public:
  explicit AttachedFiles(const std::vector<recording::McapAttachment>& attachments,
                         const std::string& mode = "") {
    recording::FileSink sink(path_, recording::Existing::kReplace);
    recording::McapWriter writer(sink);
    EXPECT_TRUE(writer.Open().ok());
    if (!mode.empty()) {
      EXPECT_TRUE(writer.WriteMetadata({"sinew.recording", {{"mode", mode}}}).ok());
    }
    for (const auto& attachment : attachments) {
      EXPECT_TRUE(writer.WriteAttachment(attachment).ok());
    }
    EXPECT_TRUE(writer.Close().ok());
    EXPECT_TRUE(sink.Close().ok());
  }
  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path target() const { return folder_.path() / "files"; }

 private:
  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_.path() / "run.mcap";
};

TEST(RecordedParts, AreTheProcessesThatRunInProcess) {
  const auto parts = PartsOf(SomeDeployment(), {});
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[0].name, "regime");
  EXPECT_EQ(parts[1].program, "sinew-control");
  EXPECT_EQ(parts[1].config, "control.yaml");
}

TEST(RecordedParts, ANameThatIsNotThereAndArgumentsAreRefused) {
  launch::Deployment deployment = SomeDeployment();
  deployment.processes[2].arguments = {"--model", "other.yaml"};
  EXPECT_NE(UsageErrorOf([&] {
              (void)PartsOf(deployment, {"controll"});
            }).find("no process 'controll', expected one of: surrogate, regime, control, logger"),
            std::string::npos);
  EXPECT_NE(UsageErrorOf([&] {
              (void)PartsOf(deployment, {"control"});
            }).find("process 'control' has arguments"),
            std::string::npos);
}

TEST(RecordedParts, AttachedFilesAreADeployment) {
  const AttachedFiles recorded(
      {{"rig/deploy.yaml", "text/yaml", 0, "# the rig\nschema: sinew-deployment/1\nname: rig\n"},
       {"/abs/rig/regime.yaml", "text/yaml", 0, "schema: sinew-regime/1\n"}},
      "lockstep");
  recording::FileSource source(recorded.path());
  const recording::McapReader reader(source);
  EXPECT_EQ(UnpackDeployment(reader, "run.mcap", recorded.target()),
            recorded.target() / "rig/deploy.yaml");
  EXPECT_EQ(config::ReadFile(recorded.target() / "abs/rig/regime.yaml"),
            "schema: sinew-regime/1\n");
  EXPECT_EQ(ModeOf(reader, "run.mcap"), node::TimeMode::kLockstep);
  EXPECT_EQ(ModeOf(reader, "run.mcap", node::TimeMode::kRealtime), node::TimeMode::kLockstep);
}

TEST(RecordedParts, AnAttachmentThatLeadsOutOfItsFolderIsRefused) {
  const AttachedFiles recorded(
      {{"../deploy.yaml", "text/yaml", 0, "schema: sinew-deployment/1\n"}});
  recording::FileSource source(recorded.path());
  const recording::McapReader reader(source);
  EXPECT_EQ(UsageErrorOf([&] { (void)UnpackDeployment(reader, "run.mcap", recorded.target()); }),
            "run.mcap: attachment '../deploy.yaml', expected the name of a file");
}

TEST(RecordedParts, WithoutAttachmentsOrMetadataTheRecordingIsRefused) {
  const AttachedFiles recorded({});
  recording::FileSource source(recorded.path());
  const recording::McapReader reader(source);
  EXPECT_EQ(UsageErrorOf([&] { (void)UnpackDeployment(reader, "run.mcap", recorded.target()); }),
            "run.mcap: no deployment is attached, expected --deployment FILE");
  EXPECT_NE(UsageErrorOf([&] { (void)ModeOf(reader, "run.mcap"); }).find("do not say the mode"),
            std::string::npos);
  EXPECT_EQ(ModeOf(reader, "run.mcap", node::TimeMode::kRealtime), node::TimeMode::kRealtime);
}

// Two sessions; in the first one the clock was set back by 6 s at tick 600 of 1400.
TEST(RecordedTicks, AreAllThereWhereTheClockWasSetBack) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "set_back.mcap";
  {
    recording::FileSink sink(file, recording::Existing::kReplace);
    recording::McapWriter writer(sink);
    ASSERT_TRUE(writer.Open().ok());
    const node::TopicInfo& info = *node::FindTopic("joint_state");
    recording::ChannelId channel{};
    ASSERT_TRUE(
        recording::AddTopic({info.name, info.type_name, info.idl, info.idl_hash}, &writer, &channel)
            .ok());
    for (std::uint64_t i = 0; i < 1500; ++i) {
      msg::JointState state;
      state.header.session_id = i < 1400 ? 1 : 2;
      state.header.tick = i % 1400;
      state.header.stamp_ns = 1'700'000'000'000'000'000 + 10'000'000 * static_cast<std::int64_t>(i);
      if (i >= 600) state.header.stamp_ns -= 6'000'000'000;
      node::Bytes bytes;
      ASSERT_TRUE(node::Encode(state, &bytes));
      ASSERT_TRUE(
          writer.WriteMessage(channel, state.header.stamp_ns, state.header.stamp_ns, bytes).ok());
    }
    ASSERT_TRUE(writer.Close().ok() && sink.Close().ok());
  }
  recording::FileSource source(file);
  const recording::McapReader reader(source);
  const std::vector<Session> sessions = SessionsOf(reader, file.string());
  ASSERT_EQ(sessions.size(), 2u);
  EXPECT_EQ(sessions[0].first_tick, 0u);
  EXPECT_EQ(sessions[0].last_tick, 1399u);
  EXPECT_EQ(sessions[0].states, 1400u);
  RecordedTicks recorded(reader, sessions[0], {"joint_state"});
  for (std::uint64_t tick = 0; tick < 1400; ++tick) ASSERT_EQ(recorded.Next(), tick);
  EXPECT_EQ(recorded.Next(), std::nullopt);
}

}  // namespace
}  // namespace sinew::rerun
