// Recordings of the rig's processes, run again in one process with the files that they carry.
// Domain 216.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/program.h"
#include "tests/support/sinew_program.h"
#include "tests/support/temporary_folder.h"

namespace sinew::testing {
namespace {

using namespace std::chrono_literals;

const std::string kRerunRig = SINEW_SOURCE_DIR "/robots/rig/";

TEST(Rerun, OfTheRigsProcessesIsIdenticalAndAnotherControllerIsNot) {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "rig.mcap").string();
  const std::string deployment = kRerunRig + "deploy_esn.yaml";
  const Finished recorded = testing::Run({kSinew, "launch", deployment, "--set", "mode=lockstep",
                                          "--duration", "4", "--domain", "216", "--record", file},
                                         120s);
  ASSERT_EQ(recorded.exit_code, 0) << recorded.output << recorded.error;

  const Finished same = testing::Run({kSinew, "rerun", file}, 60s);
  EXPECT_EQ(same.exit_code, 0) << same.output << same.error;
  for (const char* name : {"pneumatics", "regime", "reference", "esn", "rls", "control"}) {
    EXPECT_NE(same.output.find(std::string(name) + ": identical; "), std::string::npos)
        << same.output;
  }
  EXPECT_NE(same.output.find("control: identical; 960 messages of 960 ticks compared"),
            std::string::npos)
      << same.output;

  const Finished other = testing::Run({kSinew, "rerun", file, "--component", "control", "--set",
                                       "control.config=" + kRerunRig + "control_pid_model.yaml"},
                                      60s);
  EXPECT_EQ(other.exit_code, 1) << other.error;
  EXPECT_NE(other.output.find("control: differs at tick "), std::string::npos) << other.output;
  EXPECT_NE(other.output.find(": joint_command."), std::string::npos) << other.output;
}

// Also in their first second, in which they stand by. What was published too late or lost is no
// difference.
TEST(Rerun, OfTheRigsProcessesInRealTimeDiffersNowhere) {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "rig.mcap").string();
  const Finished recorded = testing::Run({kSinew, "launch", kRerunRig + "deploy_rig.yaml",
                                          "--duration", "3", "--domain", "216", "--record", file},
                                         120s);
  ASSERT_EQ(recorded.exit_code, 0) << recorded.output << recorded.error;

  const Finished again = testing::Run({kSinew, "rerun", file, "--json"}, 60s);
  ASSERT_TRUE(nlohmann::json::accept(again.output)) << again.output << again.error;
  const nlohmann::json components = nlohmann::json::parse(again.output)["components"];
  EXPECT_EQ(components.size(), 6u);
  for (const auto& component : components) {
    EXPECT_NE(component["verdict"], "differs") << component;
    EXPECT_NE(component["verdict"], "nothing recorded") << component;
  }
}

}  // namespace
}  // namespace sinew::testing
