// The proof of the axes' watchdogs with bridge, bus and virtual axes as processes. Domains 46, 47.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bridge/joints/file/proof_file.h"
#include "tests/bridge/participant/can_rig.h"

namespace sinew {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

testing::Finished ArmByHand(int domain) {
  return testing::Run(
      {std::string(SINEW_BIN_DIR) + "/sinew", "arm", "--domain", std::to_string(domain)});
}

testing::Finished Prove(const Rig& rig) {
  return testing::Run({std::string(SINEW_BIN_DIR) + "/sinew-can-bridge", "--config",
                       rig.bridge_config(), "--prove-watchdogs"});
}

RigOptions Proven(int watchdog_ms) {
  return {.bridge_more = "watchdog_proof: proof.yaml\n",
          .watchdog_ms = watchdog_ms,
          .serial_number = "3861324d3037"};
}

void End(Rig* rig) {
  rig->bridge().Signal(SIGTERM);
  EXPECT_EQ(rig->bridge().Wait(seconds(10)), 0) << rig->bridge().error();
}

bool IsValid(const msg::JointState& state) { return state.valid[0]; }

TEST(WatchdogProofSystem, OnlyAnAxisWhoseWatchdogWasProvenIsArmed) {
  Rig rig(46, Proven(80));  // the axes' process is late now and then
  ASSERT_TRUE(rig.Run(0.0, seconds(20), IsValid)) << rig.bridge().error();
  const testing::Finished refused = ArmByHand(46);
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.error,
              AllOf(HasSubstr("arm refused"), HasSubstr("joint 'joint' (axis node 3"),
                    HasSubstr("3861324D3037"), HasSubstr("--prove-watchdogs")));
  EXPECT_TRUE(rig.bridge().WaitForText("arm refused", seconds(5)));
  const std::uint64_t until = rig.last().header.tick + 120;
  ASSERT_TRUE(
      rig.Run(0.0, seconds(10), [&](const msg::JointState& s) { return s.header.tick > until; }));
  EXPECT_EQ(rig.last().robot_state, msg::RobotState::kDisarmed);

  End(&rig);
  // A machine that stalls for the length of a watchdog spoils a trial, and says so.
  testing::Finished proof;
  for (int k = 0; k < 6; ++k) {
    proof = Prove(rig);
    if (proof.exit_code == 0) break;
    EXPECT_THAT(proof.output, HasSubstr("NO PROOF"));
  }
  ASSERT_EQ(proof.exit_code, 0) << proof.output << proof.error;
  EXPECT_THAT(proof.output, HasSubstr("its watchdog idles it within"));
  const auto kept = bridge::ReadProofs(rig.folder() / "proof.yaml");
  ASSERT_EQ(kept.size(), 1U);
  EXPECT_EQ(kept[0].serial_number, "3861324D3037");
  EXPECT_GE(kept[0].idle_after_ms, 90.0);
  EXPECT_LE(kept[0].idle_after_ms, 110.0);
  rig.StartBridge();
  ASSERT_TRUE(rig.Run(0.0, seconds(20), IsValid)) << rig.bridge().error();
  ASSERT_TRUE(rig.Arm()) << rig.bridge().error();

  // Who else would command the bus sends nothing, and the proof stands.
  const testing::Finished again = Prove(rig);
  const testing::Finished second =
      testing::Run({std::string(SINEW_BIN_DIR) + "/sinew-can-bridge", "--config",
                    rig.bridge_config(), "--domain", "47"});
  for (const testing::Finished& refusal : {again, second}) {
    EXPECT_EQ(refusal.exit_code, 2);
    EXPECT_THAT(refusal.error, HasSubstr("commands it already"));
  }
  EXPECT_EQ(bridge::ReadProofs(rig.folder() / "proof.yaml").size(), 1U);
  const std::uint64_t later = rig.last().header.tick + 60;
  ASSERT_TRUE(
      rig.Run(0.0, seconds(10), [&](const msg::JointState& s) { return s.header.tick > later; }));
  EXPECT_EQ(rig.last().robot_state, msg::RobotState::kArmed) << rig.bridge().error();
}

TEST(WatchdogProofSystem, AnAxisWhoseWatchdogIsOffGetsNoProofAndIsNotArmed) {
  Rig rig(47, Proven(0));
  ASSERT_TRUE(rig.Run(0.0, seconds(20), IsValid)) << rig.bridge().error();
  End(&rig);
  // Of a controller whose settings were lost since.
  bridge::WriteProofs(rig.folder() / "proof.yaml",
                      {{"joint", "3861324D3037", 3, can::Firmware::k0_5_6, 104.0, "then"}});
  const testing::Finished proof = Prove(rig);
  EXPECT_EQ(proof.exit_code, 1) << proof.output;
  EXPECT_THAT(proof.output, AllOf(HasSubstr("NO PROOF"), HasSubstr("idled by command")));
  EXPECT_TRUE(bridge::ReadProofs(rig.folder() / "proof.yaml").empty());
  const std::string frames = ReadText(rig.log());
  const std::size_t closed_loop = frames.rfind(" 067#08000000");
  ASSERT_NE(closed_loop, std::string::npos) << "it was armed";
  EXPECT_NE(frames.find(" 067#01000000", closed_loop), std::string::npos) << "and idled";

  rig.StartBridge();
  ASSERT_TRUE(rig.Run(0.0, seconds(20), IsValid)) << rig.bridge().error();
  const testing::Finished refused = ArmByHand(47);
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.error, HasSubstr("arm refused"));
}

}  // namespace
}  // namespace sinew
