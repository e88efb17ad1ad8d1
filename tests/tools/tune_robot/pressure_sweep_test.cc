// The biped with SEA-PEA actuators: what the pressure does.
#include "tools/tune_robot/pressure_sweep.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "tools/tune_robot/tune_file.h"

namespace sinew::tune {
namespace {

constexpr std::size_t kSweptKnee = 3;

PressureSweepConfig ShippedSweep() {
  return LoadPressureSweep(SINEW_SOURCE_DIR "/robots/biped/tune_pressure.yaml");
}

// Down to the lowest point of the first squat: 0.5 s of delay, 3 s of soft start, half of 5 s.
TEST(PressureSweep, ThePneumaticElementsTakeTheLoadOffTheKnees) {
  PressureSweepConfig config = ShippedSweep();
  config.pressure_bar = {0.0, 4.0};
  config.rigid.duration_s = config.elastic.duration_s = 6.0;
  const std::vector<PressurePoint> points = SweepPressure(config);
  ASSERT_EQ(points.size(), 3u);
  for (const PressurePoint& point : points) ASSERT_TRUE(point.stands());
  const RobotTrialResult &rigid = points[0].trial, &slack = points[1].trial,
                         &held = points[2].trial;
  // Without pressure the play alone is added. The static torque at the lowest point is 14.05 N m
  // (README.md); PID alone adds what its error and the motion ask for.
  EXPECT_NEAR(slack.peak_torque_Nm[kSweptKnee], rigid.peak_torque_Nm[kSweptKnee],
              0.2 * rigid.peak_torque_Nm[kSweptKnee]);
  EXPECT_GT(rigid.peak_torque_Nm[kSweptKnee], 14.05);
  // At 4 bar the element carries half of the 14.05 N m.
  EXPECT_NEAR(rigid.peak_torque_Nm[kSweptKnee] - held.peak_torque_Nm[kSweptKnee], 0.5 * 14.05,
              0.25 * 14.05);
  // Copper loss goes with the torque's square: less than half of it.
  EXPECT_LT(held.performance.joint[kSweptKnee].energies.copper_loss_J,
            0.5 * rigid.performance.joint[kSweptKnee].energies.copper_loss_J);
  // The managers hold the pressure while the knee bends.
  EXPECT_NEAR(held.least_pressure_bar[kSweptKnee], 4.0, 0.2);
  EXPECT_NEAR(held.most_pressure_bar[kSweptKnee], 4.0, 0.2);
  EXPECT_EQ(BestPressure(points), &points[2]);
}

TEST(PressureSweep, TheBestIsOneAtWhichTheRobotStands) {
  std::vector<PressurePoint> points(4);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i > 0) points[i].pressure_bar = static_cast<double>(i);
    points[i].trial.performance.drawn_J = 100.0 - 10.0 * static_cast<double>(i);
  }
  points[3].trial.score.fell_at_s = 2.0;
  EXPECT_EQ(BestPressure(points), &points[2]);
  points[2].trial.score.faulted = true;
  EXPECT_EQ(BestPressure(points), &points[1]);
  points[1].trial.score.faulted = true;
  EXPECT_EQ(BestPressure(points), nullptr) << "the rigid robot has no pressure";
}

TEST(PressureSweep, RefusesWhatHasNoPressure) {
  PressureSweepConfig bad = ShippedSweep();
  bad.pressure_bar = {};
  EXPECT_THROW((void)SweepPressure(bad), std::invalid_argument);
  bad = ShippedSweep();
  bad.pressure_bar = {-1.0};
  EXPECT_THROW((void)SweepPressure(bad), std::invalid_argument);
  bad.pressure_bar = {std::numeric_limits<double>::quiet_NaN()};
  EXPECT_THROW((void)SweepPressure(bad), std::invalid_argument);
  bad = ShippedSweep();
  bad.elastic.robot.model = bad.rigid.robot.model;
  EXPECT_THROW((void)SweepPressure(bad), std::invalid_argument);
  bad = ShippedSweep();
  bad.elastic.pneumatics.resize(4);  // none for the ankle and the right leg
  EXPECT_THROW((void)SweepPressure(bad), std::invalid_argument);
  bad = ShippedSweep();
  bad.elastic.robot.joints[kSweptKnee].has_pneumatics = false;
  EXPECT_THROW((void)SweepPressure(bad), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::tune
