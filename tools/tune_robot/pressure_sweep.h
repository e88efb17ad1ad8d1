// The worth of pneumatic elements in a robot's joints: the same motion with rigid actuators and
// with SEA-PEA ones, their pressure as the parameter.
//
// At each pressure chamber and reservoir begin at it, and the pressure managers hold it. Energies
// are sinew-performance's (components/robot/performance/energy.h); none counts the air that
// compressor and leak cost. SI units, gauge pressure in bar.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "tools/tune_robot/robot_trial.h"

namespace sinew::tune {

struct PressureSweepConfig {
  RobotTrialConfig rigid;    // pressures play no part
  RobotTrialConfig elastic;  // with pneumatic elements, and a pressure manager for every joint
  std::vector<double> pressure_bar;
  int threads = 1;
};

struct PressurePoint {
  std::optional<double> pressure_bar;  // nothing: the rigid robot
  RobotTrialResult trial;

  bool stands() const noexcept { return !trial.score.fell_at_s && !trial.score.faulted; }
};

// Joints of the robot's model with a torque that depends on the pressure, by index.
std::vector<std::size_t> PneumaticJoints(const actuator::RobotModel& model);

// The elastic robot at a pressure.
RobotTrialConfig AtPressure(const RobotTrialConfig& elastic, double pressure_bar);

// The rigid robot first, then the pressures in their order. progress: points done and all; may be
// empty. Throws std::invalid_argument: no pressure, a negative one, a model without pneumatic
// joints, such a joint without chamber in the world or without manager; and as RunRobotTrial.
std::vector<PressurePoint> SweepPressure(
    const PressureSweepConfig& config,
    const std::function<void(std::size_t done, std::size_t total)>& progress = {});

// The point, of those with a pressure on which the robot stands, that draws least electrical
// energy; nullptr when there is none.
const PressurePoint* BestPressure(const std::vector<PressurePoint>& points) noexcept;

}  // namespace sinew::tune
