#include "tools/tune_robot/pressure_sweep.h"

#include <cmath>
#include <stdexcept>

#include "tools/jobs/jobs.h"

namespace sinew::tune {
namespace {

void CheckSweep(const PressureSweepConfig& config) {
  if (config.pressure_bar.empty()) throw std::invalid_argument("pressure_bar: no pressure");
  for (const double pressure_bar : config.pressure_bar) {
    if (std::isfinite(pressure_bar) && pressure_bar >= 0.0) continue;
    throw std::invalid_argument("pressure_bar: " + std::to_string(pressure_bar) +
                                ", expected 0 or more");
  }
  const world::FloatingRobotConfig& robot = config.elastic.robot;
  const std::vector<std::size_t> joints = PneumaticJoints(robot.model);
  if (joints.empty()) {
    throw std::invalid_argument("model '" + robot.model.name +
                                "': no joint has pneumatic_torque, expected SEA-PEA actuators");
  }
  for (const std::size_t j : joints) {
    const std::string name = "joint '" + robot.model.joints[j].name + "': ";
    if (j >= robot.joints.size() || !robot.joints[j].has_pneumatics) {
      throw std::invalid_argument(name + "no pneumatics in the world file");
    }
    if (j >= config.elastic.pneumatics.size()) {
      throw std::invalid_argument(name + "no pressure manager");
    }
  }
}

}  // namespace

std::vector<std::size_t> PneumaticJoints(const actuator::RobotModel& model) {
  std::vector<std::size_t> joints;
  for (std::size_t j = 0; j < model.joints.size(); ++j) {
    if (model.joints[j].Find("pneumatic_torque") >= 0) joints.push_back(j);
  }
  return joints;
}

RobotTrialConfig AtPressure(const RobotTrialConfig& elastic, double pressure_bar) {
  RobotTrialConfig trial = elastic;
  for (const std::size_t j : PneumaticJoints(trial.robot.model)) {
    trial.robot.joints[j].pneumatics.initial_pressure_bar = pressure_bar;
    trial.robot.joints[j].pneumatics.source_pressure_bar = pressure_bar;
    trial.pneumatics[j].target_bar = pressure_bar;
  }
  return trial;
}

std::vector<PressurePoint> SweepPressure(
    const PressureSweepConfig& config,
    const std::function<void(std::size_t, std::size_t)>& progress) {
  CheckSweep(config);
  std::vector<PressurePoint> points(1 + config.pressure_bar.size());
  std::vector<std::function<void()>> jobs;
  jobs.emplace_back([&config, &points] { points[0].trial = RunRobotTrial(config.rigid); });
  for (std::size_t i = 0; i < config.pressure_bar.size(); ++i) {
    points[i + 1].pressure_bar = config.pressure_bar[i];
    jobs.emplace_back([&config, &point = points[i + 1]] {
      point.trial = RunRobotTrial(AtPressure(config.elastic, *point.pressure_bar));
    });
  }
  tools::RunJobs(jobs, config.threads, [&](std::size_t done) {
    if (progress) progress(done, jobs.size());
  });
  return points;
}

const PressurePoint* BestPressure(const std::vector<PressurePoint>& points) noexcept {
  const PressurePoint* best = nullptr;
  for (const PressurePoint& point : points) {
    if (!point.pressure_bar || !point.stands()) continue;
    if (best == nullptr || point.trial.performance.drawn_J < best->trial.performance.drawn_J) {
      best = &point;
    }
  }
  return best;
}

}  // namespace sinew::tune
