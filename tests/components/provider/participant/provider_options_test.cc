#include "components/provider/participant/provider_options.h"

#include <gtest/gtest.h>

#include <chrono>
#include <string>

namespace sinew::provider {
namespace {

GuardConfig Load(const std::string& guard) {
  const config::Section section =
      config::Section::Parse("schema: test/1\nguard: {" + guard + "}\n", "file.yaml", "test/1");
  const GuardConfig config = LoadGuardConfig(section.ChildOrEmpty("guard"));
  section.RejectUnknownKeys();
  return config;
}

TEST(GuardConfig, HasTheDefaultsOfTheGuard) {
  const GuardConfig loaded = Load(""), expected;
  EXPECT_EQ(loaded.missed_periods, expected.missed_periods);
  EXPECT_EQ(loaded.fault_after, expected.fault_after);
  EXPECT_EQ(loaded.bridging, expected.bridging);
  EXPECT_EQ(loaded.damping_Nm_s_rad, expected.damping_Nm_s_rad);
  EXPECT_EQ(loaded.on_joint_fault, expected.on_joint_fault);
  EXPECT_EQ(loaded.valves_in_fault, ValvesInFault::kHold);
}

TEST(GuardConfig, ReadsEveryKey) {
  const GuardConfig config =
      Load("missed_periods: 5, fault_after_ms: 80, bridging: hold, damping_Nm_s_rad: 0.001");
  EXPECT_EQ(config.missed_periods, 5);
  EXPECT_EQ(config.fault_after, std::chrono::milliseconds(80));
  EXPECT_EQ(config.bridging, Bridging::kHold);
  EXPECT_EQ(config.damping_Nm_s_rad, 0.001);
}

TEST(GuardConfig, ReadsThePolicyForTheOtherJoints) {
  EXPECT_EQ(Load("on_joint_fault: idle").on_joint_fault, OtherJointsPolicy::kIdle);
  EXPECT_EQ(Load("on_joint_fault: damp").on_joint_fault, OtherJointsPolicy::kDamp);
  EXPECT_EQ(Load("on_joint_fault: hold").on_joint_fault, OtherJointsPolicy::kHold);
  EXPECT_EQ(Load("on_joint_fault: continue").on_joint_fault, OtherJointsPolicy::kContinue);
}

TEST(GuardConfig, ReadsWhatTheValvesOfAStoppedRobotDo) {
  EXPECT_EQ(Load("valves_in_fault: hold").valves_in_fault, ValvesInFault::kHold);
  EXPECT_EQ(Load("valves_in_fault: vent").valves_in_fault, ValvesInFault::kVent);
}

TEST(GuardConfig, RefusesWhatHasNoMeaning) {
  for (const char* text :
       {"missed_periods: 0", "missed_periods: 101", "fault_after_ms: 0", "bridging: jump",
        "damping_Nm_s_rad: -1", "on_joint_fault: rest", "valves_in_fault: close", "unknown: 1"}) {
    EXPECT_THROW(Load(text), UsageError) << text;
  }
}

}  // namespace
}  // namespace sinew::provider
