// A full disk is the logger's trouble and nobody else's.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <iterator>
#include <set>
#include <sstream>

#include "tests/support/patient_guard.h"
#include "tests/support/program.h"
#include "tests/support/skip.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_host.h"

namespace sinew::testing {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string kSinew = SINEW_BIN_DIR "/sinew";
const std::string kDeployment = SINEW_SOURCE_DIR "/robots/rig/deploy_rig.yaml";
constexpr auto kEnough = 60s;

std::vector<std::string> Values(const std::string& text) {
  std::istringstream in(text);
  return {std::istream_iterator<std::string>(in), std::istream_iterator<std::string>()};
}

TEST(FullDisk, EndsTheRecordingAndTheRobotGoesOn) {
  TestHost host;
  const std::string disk = host.MakeDisk("1M");  // a few seconds of all topics
  SKIP_WITHOUT_KERNEL(host.why_not().empty(), host.why_not());
  const std::string file = disk + "/run.mcap";
  const auto sinew = [&host](std::vector<std::string> line) {
    line.insert(line.begin(), kSinew);
    return host.Line(line);
  };

  const TemporaryFolder folder;
  Program status(sinew({"echo", "component_status", "--domain", "58", "--timeout", "60"}));
  Program launch(
      sinew({"launch", kDeployment, "--mode", "realtime", "--duration", "0", "--domain", "58",
             "--record", file, "--set", "surrogate.config=" + PatientSurrogate(folder)}));
  // Reported by the logger, in its status and by the launcher, which starts it again beside.
  const std::string what = file + ": cannot be written: ";
  EXPECT_TRUE(launch.WaitForText(what, kEnough)) << launch.error();
  EXPECT_TRUE(launch.WaitForText("No space left on device", kEnough)) << launch.error();
  EXPECT_TRUE(launch.WaitForText("logger failed: exit code 1", kEnough)) << launch.output();
  EXPECT_TRUE(status.WaitForText(what, kEnough)) << status.output() << status.error();
  EXPECT_TRUE(launch.WaitForText("the others go on", kEnough)) << launch.output();

  // The robot: armed, and its ticks go on.
  const Finished ticks = testing::Run(
      sinew({"echo", "joint_state", "--domain", "58", "--field", "robot_state", "--count", "240"}));
  EXPECT_EQ(ticks.exit_code, 0) << ticks.error;
  const std::vector<std::string> states = Values(ticks.output);
  EXPECT_THAT(std::set<std::string>(states.begin(), states.end()),
              ::testing::ElementsAre("ROBOT_ARMED"));

  launch.Signal(SIGINT);
  EXPECT_EQ(launch.Wait(kEnough), 1) << "a failure is no success, also that of an observer";
  EXPECT_THAT(launch.error() + launch.output(), Not(HasSubstr("surrogate failed")));

  // What was recorded until then can be read.
  const Finished recorded =
      testing::Run(sinew({"echo", "joint_state", "--from", file, "--field", "header.tick"}));
  EXPECT_EQ(recorded.exit_code, 0) << recorded.error;
  EXPECT_GT(Values(recorded.output).size(), 100u);
}

}  // namespace
}  // namespace sinew::testing
