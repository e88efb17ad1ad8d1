#include "tools/tune_robot/robot_trial.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>
#include <stdexcept>
#include <string>

#include "components/base/types/require.h"

namespace sinew::tune {
namespace {

void CheckTrial(const RobotTrialConfig& config, int joints) {
  const auto expect = [joints](const char* what, std::size_t count) {
    if (count == static_cast<std::size_t>(joints)) return;
    throw std::invalid_argument(std::string(what) + ": " + std::to_string(count) +
                                " joints, expected the robot's " + std::to_string(joints));
  };
  expect("control", config.control.size());
  expect("reference", config.reference.joints.size());
  expect("performance", config.performance.robot.joints.size());
  if (config.pneumatics.size() > static_cast<std::size_t>(joints)) {
    expect("pneumatics", config.pneumatics.size());
  }
  types::Require(config.rate_Hz > 0.0, "rate_Hz", config.rate_Hz, "above 0");
  types::Require(config.duration_s > 0.0, "duration_s", config.duration_s, "above 0");
}

// Meter of the trial beside the tracking: energies, peaks, heights.
class Meter {
 public:
  Meter(const RobotTrialConfig& config, const world::FloatingRobot& robot)
      : robot_(robot),
        joints_(static_cast<std::size_t>(robot.joint_count())),
        has_chamber_(config.robot.joints.size()),
        reference_from_s_(config.reference.start_delay_s),
        height_(config.performance.height),
        performance_(config.performance.robot, 1.0 / config.rate_Hz) {
    for (std::size_t j = 0; j < has_chamber_.size(); ++j) {
      has_chamber_[j] = config.robot.joints[j].has_pneumatics;
    }
    result_.least_height_m = std::numeric_limits<double>::infinity();
  }

  void Step(double time_s, const provider::PlantSensors& sensors) {
    std::array<performance::JointSample, types::kMaxJoints> samples{};
    for (std::size_t j = 0; j < joints_; ++j) {
      samples[j].position_rad = sensors.position_rad[j];
      samples[j].velocity_rad_s = sensors.velocity_rad_s[j];
      samples[j].torque_Nm = sensors.torque_Nm[j];
      samples[j].current_A = sensors.motor_current_A[j];
      result_.peak_torque_Nm[j] =
          std::max(result_.peak_torque_Nm[j], std::abs(sensors.torque_Nm[j]));
      if (j >= has_chamber_.size() || !has_chamber_[j]) continue;
      const double pressure_bar = sensors.chamber_pressure_bar[j];
      const double least = ticks_ == 0 ? pressure_bar : result_.least_pressure_bar[j];
      const double most = ticks_ == 0 ? pressure_bar : result_.most_pressure_bar[j];
      result_.least_pressure_bar[j] = std::min(least, pressure_bar);
      result_.most_pressure_bar[j] = std::max(most, pressure_bar);
    }
    if (time_s >= reference_from_s_) {
      result_.least_height_m = std::min(result_.least_height_m, robot_.body_truth()->position_m[2]);
    }
    const double height_m = height_ ? height_->Of(std::span(sensors.position_rad).first(joints_))
                                    : std::numeric_limits<double>::quiet_NaN();
    result_.performance = performance_.Step(ticks_++, std::span(samples).first(joints_), height_m);
  }

  const RobotTrialResult& result() const { return result_; }

 private:
  const world::FloatingRobot& robot_;
  std::size_t joints_;
  std::vector<bool> has_chamber_;
  double reference_from_s_;
  std::optional<performance::CentreHeight> height_;
  performance::RobotPerformance performance_;
  std::uint64_t ticks_ = 0;
  RobotTrialResult result_;
};

}  // namespace

RobotTrialResult RunRobotTrial(const RobotTrialConfig& config) {
  world::FloatingRobot robot(config.robot);
  CheckTrial(config, robot.joint_count());
  Meter meter(config, robot);
  ClosedLoopConfig loop = config;
  loop.scored_joints.resize(static_cast<std::size_t>(robot.joint_count()));
  std::iota(loop.scored_joints.begin(), loop.scored_joints.end(), 0);
  loop.each_tick = [&meter](double time_s, const provider::PlantSensors& sensors) {
    meter.Step(time_s, sensors);
  };
  loop.fallen = [&robot, &config] { return HasFallen(robot, config.fall); };
  const ClosedLoopScore score = RunClosedLoop(loop, robot);
  RobotTrialResult result = meter.result();
  result.score = score;
  return result;
}

}  // namespace sinew::tune
