// Trials of the biped on the ground.
#include "tools/tune_robot/robot_trial.h"

#include <gtest/gtest.h>

#include <array>
#include <stdexcept>
#include <thread>

#include "tools/tune_robot/tune_file.h"

namespace sinew::tune {
namespace {

const std::string kSearchFile = SINEW_SOURCE_DIR "/robots/biped/tune_pid.yaml";

RobotTrialConfig TrialWith(double proportional, double integral, double derivative) {
  RobotTrialConfig trial = LoadTune(kSearchFile).trial;
  trial.delay_ticks = 0;
  for (control::JointControlConfig& joint : trial.control) {
    joint.pid.proportional_Nm_rad = proportional;
    joint.pid.integral_Nm_rad_s = integral;
    joint.pid.derivative_Nm_s_rad = derivative;
  }
  return trial;
}

TEST(RobotTrial, WithThePublishedGainsTheRobotFallsAndTheTimeIsKept) {
  const RobotTrialResult fell = RunRobotTrial(TrialWith(60.0, 3.5, 1.0));
  ASSERT_TRUE(fell.score.fell_at_s.has_value());
  EXPECT_GT(*fell.score.fell_at_s, 0.5);
  EXPECT_LT(*fell.score.fell_at_s, 3.0);
  EXPECT_EQ(TrackingCost(fell.score), kDiscarded);
  // It falls by its tilt; the height alone notices it later.
  RobotTrialConfig height = TrialWith(60.0, 3.5, 1.0);
  height.fall.most_tilt_rad = 3.0;
  const RobotTrialResult later = RunRobotTrial(height);
  ASSERT_TRUE(later.score.fell_at_s.has_value());
  EXPECT_GT(*later.score.fell_at_s, *fell.score.fell_at_s);
  EXPECT_LT(later.least_height_m, height.fall.least_height_m + 0.05);
}

TEST(RobotTrial, StandsStillWithStifferGainsAndNoSlowerInAnotherThread) {
  RobotTrialConfig trial = TrialWith(200.0, 20.0, 5.0);
  trial.duration_s = 3.0;
  std::array<RobotTrialResult, 2> results;
  std::thread other([&] { results[1] = RunRobotTrial(trial); });
  results[0] = RunRobotTrial(trial);
  other.join();
  EXPECT_FALSE(results[0].score.fell_at_s.has_value());
  EXPECT_FALSE(results[0].score.faulted);
  EXPECT_GT(results[0].score.mse_rad2, 0.0);
  EXPECT_LT(results[0].score.mse_rad2, 1e-3);
  EXPECT_GT(results[0].least_height_m, 0.7);
  // The knee carries: 4 N m at the top (static torque of the benchmark's beginning), below its 30.
  EXPECT_GT(results[0].peak_torque_Nm[3], 2.0);
  EXPECT_LT(results[0].peak_torque_Nm[3], 29.9);
  EXPECT_EQ(results[0].score.mse_rad2, results[1].score.mse_rad2);
  EXPECT_EQ(results[0].performance.drawn_J, results[1].performance.drawn_J);
  EXPECT_EQ(results[0].peak_torque_Nm, results[1].peak_torque_Nm);
}

// README.md of the robot: the gains of least error without a delay.
TEST(RobotTrial, StiffGainsFallWithATickOfDelayAndSofterOnesDoNot) {
  const auto fell_at_s = [](RobotTrialConfig trial, int delay_ticks) {
    trial.duration_s = 3.0;
    trial.delay_ticks = delay_ticks;
    return RunRobotTrial(trial).score.fell_at_s;
  };
  const RobotTrialConfig stiff = TrialWith(605.7, 621.1, 1.485), soft = TrialWith(200.0, 20.0, 5.0);
  EXPECT_FALSE(fell_at_s(stiff, 0).has_value());
  EXPECT_TRUE(fell_at_s(stiff, 1).has_value());
  EXPECT_FALSE(fell_at_s(soft, 1).has_value());
}

TEST(RobotTrial, RefusesPartsThatAreOfAnotherRobot) {
  RobotTrialConfig bad = TrialWith(200.0, 20.0, 5.0);
  bad.control.pop_back();
  EXPECT_THROW((void)RunRobotTrial(bad), std::invalid_argument);
  bad = TrialWith(200.0, 20.0, 5.0);
  bad.reference.joints.pop_back();
  EXPECT_THROW((void)RunRobotTrial(bad), std::invalid_argument);
  bad = TrialWith(200.0, 20.0, 5.0);
  bad.duration_s = 0.0;
  EXPECT_THROW((void)RunRobotTrial(bad), std::invalid_argument);
  bad.duration_s = 1.0;
  bad.rate_Hz = -240.0;
  EXPECT_THROW((void)RunRobotTrial(bad), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::tune
