// The operator's commands against a running state provider, over DDS.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace sinew {
namespace {

using namespace std::chrono_literals;
using sinew::testing::Finished;
using sinew::testing::Program;
using sinew::testing::TemporaryFolder;
using ::testing::HasSubstr;

constexpr auto kLimit = 30s;
const std::string kBin = std::string(SINEW_BIN_DIR) + "/";

Finished Operate(const std::string& action, const std::string& domain,
                 const std::string& timeout_s = "10") {
  return testing::Run(
      {kBin + "sinew", action, "--domain", domain, "--timeout", timeout_s, "--json"}, kLimit);
}

std::string StateOf(const Finished& run) {
  return nlohmann::json::parse(run.output).value("robot_state", "none");
}

// One provider through all of its states: starting one takes a second of discovery.
TEST(Operator, ArmsStopsResetsAndDisarmsARunningRobot) {
  const std::string domain = "35";
  Program provider({kBin + "sinew-surrogate", "--domain", domain});

  Finished run = Operate("arm", domain);
  EXPECT_EQ(run.exit_code, 0) << run.error;
  EXPECT_THAT(StateOf(run), ::testing::AnyOf("armed", "damped"));

  run = Operate("estop", domain);
  EXPECT_EQ(run.exit_code, 0) << run.error;
  EXPECT_EQ(StateOf(run), "estopped");

  run = Operate("arm", domain, "1");
  EXPECT_EQ(run.exit_code, 1) << "an estop is latched";
  EXPECT_THAT(run.error, HasSubstr("sinew reset"));

  run = Operate("disarm", domain);
  EXPECT_EQ(run.exit_code, 0) << "its motors are off already: " << run.error;

  run = Operate("reset", domain);
  EXPECT_EQ(run.exit_code, 0) << run.error;
  EXPECT_EQ(StateOf(run), "disarmed");

  provider.Signal(SIGINT);
  EXPECT_EQ(provider.Wait(kLimit), 0) << provider.error();
}

TEST(Operator, ARobotThatIsNotThereIsAFailureThatNamesTheDomain) {
  const Finished run = Operate("estop", "36", "0.5");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.error, HasSubstr("no state provider heard in domain 36"));
}

TEST(Operator, ADeploymentIsArmedAndEndedInOrder) {
  const TemporaryFolder folder;
  const std::string file = folder.Write(
      "deploy.yaml",
      "schema: sinew-deployment/1\nname: one\ndomain_id: 37\nprovider: surrogate\nprocesses:\n"
      "  - {name: surrogate, program: sinew-surrogate}\n");
  Program launch({kBin + "sinew", "launch", file});
  EXPECT_EQ(Operate("arm", "37").exit_code, 0);
  EXPECT_TRUE(launch.WaitForText("armed", kLimit));
  launch.Signal(SIGINT);
  EXPECT_EQ(launch.Wait(kLimit), 0) << launch.error();
  EXPECT_THAT(launch.error(), HasSubstr("stopped as asked"));
}

TEST(Operator, ALockstepSessionEndsByItselfAfterItsDuration) {
  const TemporaryFolder folder;
  const std::string file = folder.Write(
      "deploy.yaml",
      "schema: sinew-deployment/1\nname: one\ndomain_id: 38\nmode: lockstep\nduration_s: 0.5\n"
      "provider: surrogate\nprocesses:\n  - {name: surrogate, program: sinew-surrogate}\n");
  const Finished run = testing::Run({kBin + "sinew", "launch", file}, kLimit);
  EXPECT_EQ(run.exit_code, 0) << run.error;
  EXPECT_THAT(run.error, HasSubstr("session ended: surrogate is done"));
}

TEST(Operator, ASecondStateProviderIsRefusedAsAUsageError) {
  Program first({kBin + "sinew-surrogate", "--domain", "39"});
  ASSERT_EQ(Operate("disarm", "39").exit_code, 0);  // it runs
  const Finished second = testing::Run({kBin + "sinew-surrogate", "--domain", "39"}, kLimit);
  EXPECT_EQ(second.exit_code, 2);
  EXPECT_THAT(second.error, HasSubstr("already has a state provider"));
}

}  // namespace
}  // namespace sinew
