// A trial of a whole robot on a floating base in one thread, without DDS: the simulation,
// reference, control and pressure managers that the participants use, tick by tick as in lockstep
// (tools/tune_pid/closed_loop.h). The robot is armed at tick 0.
//
// SI units, pressures gauge in bar. Several trials may run at the same time, each in a thread of
// its own: nothing is shared, and a trial gives bit-identical results in whichever thread it runs.
#pragma once

#include <vector>

#include "components/robot/performance/file/performance_file.h"
#include "sim/world/floating_robot.h"
#include "tools/tune_pid/closed_loop.h"

namespace sinew::tune {

// control: a joint each, in the model's order; all joints are scored, in all ticks.
struct RobotTrialConfig : ClosedLoopConfig {
  world::FloatingRobotConfig robot;
  performance::PerformanceConfig performance;
  FallLimits fall;
};

struct RobotTrialResult {
  // Over all joints and all ticks with a reference, as mean_square_error_rad2 of
  // sinew-performance; after a fall, of the ticks before.
  ClosedLoopScore score;
  // Energies from tick 0 on, as sinew-performance's; its errors are not filled.
  performance::RobotPerformanceOutput performance;
  types::JointArray<double> peak_torque_Nm{};  // of |drive torque at the joint|
  // Height of the base's origin while there is a reference; infinite when there never was one.
  double least_height_m = 0.0;
  // Measured over all ticks, of joints with a chamber; else 0.
  types::JointArray<double> least_pressure_bar{}, most_pressure_bar{};
};

// Throws std::invalid_argument: what FloatingRobot, RobotController, RobotReference or
// RobotPerformance refuse, controls or figures of performance for another number of joints, a
// duration or rate that is not positive.
RobotTrialResult RunRobotTrial(const RobotTrialConfig& config);

}  // namespace sinew::tune
