// The rig as separate processes in lockstep: repeatable to the byte.
#include <gtest/gtest.h>

#include <algorithm>

#include "components/base/config/config.h"
#include "tests/support/program.h"
#include "tests/support/sinew_program.h"
#include "tests/support/temporary_folder.h"
#include "tests/system/recording_payloads.h"

namespace sinew::testing {
namespace {

using namespace std::chrono_literals;

const std::string kDeployment = SINEW_SOURCE_DIR "/robots/rig/deploy_rig.yaml";
constexpr std::size_t kTicks = 5 * 240;

std::map<std::string, std::vector<std::string>> RunRig(const std::filesystem::path& file,
                                                       int domain, int seed) {
  const Finished run =
      Run({kSinew, "launch", kDeployment, "--set", "mode=lockstep", "--duration", "5", "--seed",
           std::to_string(seed), "--domain", std::to_string(domain), "--record", file.string()},
          120s);
  EXPECT_EQ(run.exit_code, 0) << run.output << run.error;
  auto payloads = PayloadsByTopic(file);
  payloads.erase("component_status");  // carries wall-clock facts
  payloads.erase("log");
  // Of several writers, whose order among each other is that of their threads.
  auto& snapshots = payloads["component_snapshot"];
  std::sort(snapshots.begin(), snapshots.end());
  return payloads;
}

TEST(Lockstep, TwoRunsWithOneSeedGiveIdenticalPayloadsPerTopic) {
  const TemporaryFolder folder;
  const auto first = RunRig(folder.path() / "first.mcap", 140, 7);
  const auto second = RunRig(folder.path() / "second.mcap", 141, 7);
  for (const char* topic : {"joint_state", "actuator_state", "joint_command", "valve_command",
                            "pneumatic_state", "regime", "reference", "torque_prediction",
                            "reservoir_state", "readout", "adaptation_state"}) {
    ASSERT_EQ(first.count(topic), 1u) << topic;
    EXPECT_EQ(first.at(topic).size(), kTicks) << topic;
  }
  ASSERT_EQ(first.size(), second.size());
  for (const auto& [topic, payloads] : first) {
    ASSERT_EQ(second.count(topic), 1u) << topic;
    EXPECT_EQ(payloads.size(), second.at(topic).size()) << topic;
    EXPECT_TRUE(payloads == second.at(topic)) << "payloads of " << topic << " differ";
  }
}

TEST(Lockstep, AnotherSeedGivesOtherMeasurements) {
  const TemporaryFolder folder;
  const auto first = RunRig(folder.path() / "first.mcap", 142, 7);
  const auto second = RunRig(folder.path() / "second.mcap", 143, 8);
  ASSERT_EQ(first.at("actuator_state").size(), second.at("actuator_state").size());
  EXPECT_FALSE(first.at("actuator_state") == second.at("actuator_state"));

  // The recording carries what it was made with.
  const std::string file = (folder.path() / "first.mcap").string();
  const Finished attachments = testing::Run({kSinew, "attachments", file});
  for (const char* name :
       {"deploy_rig.yaml", "surrogate.yaml", "control_pid_model.yaml", "esn_sea.json"}) {
    EXPECT_NE(attachments.output.find(name), std::string::npos) << name << attachments.output;
  }
  EXPECT_EQ(testing::Run({kSinew, "attachments", file, "deploy_rig.yaml"}).output,
            config::ReadFile(kDeployment));
}

TEST(Lockstep, AMissingReplyEndsTheSessionAndIsNamed) {
  const Finished run =
      testing::Run({SINEW_BIN_DIR "/sinew-surrogate", "--config",
                    SINEW_SOURCE_DIR "/robots/rig/surrogate.yaml", "--lockstep", "--domain", "144",
                    "--duration", "1", "--await", "joint_command", "--await-timeout", "1"},
                   30s);
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.error.find("no joint_command for tick 0 within 1 s"), std::string::npos)
      << run.error;
}

}  // namespace
}  // namespace sinew::testing
