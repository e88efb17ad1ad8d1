// Which components a recording is run again with.
#include "tools/rerun/recorded_parts.h"

#include <gtest/gtest.h>

#include <string>

#include "components/base/config/config.h"
#include "components/record/recording/file/file_io.h"
#include "components/record/recording/mcap_writer.h"
#include "tests/support/temporary_folder.h"

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
}

}  // namespace
}  // namespace sinew::rerun
