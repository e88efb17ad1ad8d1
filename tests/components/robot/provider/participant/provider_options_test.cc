#include "components/robot/provider/participant/provider_options.h"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <string>

#include "components/robot/provider/fall_guard.h"

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

std::string ErrorOf(const std::string& guard) {
  try {
    (void)Load(guard);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "none";
}

const std::string kBipedUrdf = SINEW_SOURCE_DIR "/robots/biped/biped.urdf";

TEST(GuardConfig, LooksForFallsOnlyWhenTheyAreDeclared) { EXPECT_EQ(Load("").fall, nullptr); }

TEST(GuardConfig, TakesLegsMassAndTheImusMountingOfTheFallGuardFromTheUrdf) {
  const GuardConfig config = Load(
      "fall: {urdf: " + kBipedUrdf +
      ", on_fall: damp, start_within_s: 5, pendulum_length_m: 0.9, imu: {rate_bias_rad_s: 0.1}}");
  ASSERT_NE(config.fall, nullptr);
  EXPECT_EQ(config.on_fall, FallPolicy::kDamp);
  const FallGuardConfig& fall = *config.fall;
  EXPECT_EQ(fall.joint_count, 12);
  EXPECT_EQ(fall.left.joint, (std::array{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(fall.right.joint, (std::array{6, 7, 8, 9, 10, 11}));
  EXPECT_NEAR(fall.left.geometry.hip_in_pelvis_m.y(), 0.075, 1e-12);
  EXPECT_NEAR(fall.right.geometry.thigh_m, 0.278, 1e-12);
  EXPECT_NEAR(fall.detector.mass_kg, 17.1, 1e-9);
  EXPECT_NEAR((fall.imu_from_base - Eigen::Matrix3d::Identity()).norm(), 0.0, 1e-12);
  EXPECT_EQ(fall.start_within_s, 5.0);
  EXPECT_EQ(fall.detector.tilt.pendulum_length_m, 0.9);
  EXPECT_EQ(fall.detector.tilt.imu.rate_bias_rad_s, 0.1);
  EXPECT_EQ(fall.detector.tilt.imu.force_bias_m_s2, fall::ImuBounds{}.force_bias_m_s2);
  EXPECT_NO_THROW(FallGuard(fall, 1.0 / 240.0));
}

TEST(GuardConfig, SaysWhatIsWrongWithAFallGuard) {
  using ::testing::HasSubstr;
  const std::string urdf = "urdf: " + kBipedUrdf;
  EXPECT_EQ(Load("fall: {" + urdf + "}").on_fall, FallPolicy::kIdle);
  EXPECT_THAT(ErrorOf("fall: {}"), HasSubstr("urdf"));
  EXPECT_THAT(ErrorOf("fall: {urdf: absent.urdf}"), HasSubstr("absent.urdf"));
  EXPECT_THAT(ErrorOf("fall: {urdf: " SINEW_SOURCE_DIR "/robots/rig/rig.urdf}"),
              HasSubstr("right_hip_yaw"));
  EXPECT_THAT(ErrorOf("fall: {" + urdf + ", on_fall: hold}"), HasSubstr("idle"));
  EXPECT_THAT(ErrorOf("fall: {" + urdf + ", start_within_s: 0}"), HasSubstr("start_within_s"));
  EXPECT_THAT(ErrorOf("fall: {" + urdf + ", imu: {noise: 1}}"), HasSubstr("noise"));
  EXPECT_THAT(ErrorOf("fall: {" + urdf + ", tilt_deg: 30}"), HasSubstr("tilt_deg"));
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
