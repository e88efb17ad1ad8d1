// A lockstep recording of the rig's processes, run again in one process with the files that it
// carries. Domain 216.
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace sinew::testing
