// Robots of this project as the tests export them.
#pragma once

#include <filesystem>
#include <string>

#include "components/base/config/config.h"
#include "components/bodies/links/file/urdf_file.h"
#include "components/model/actuator/file/model_file.h"
#include "tools/export_model/described_robot.h"
#include "tools/export_model/write_model.h"

namespace sinew::export_model {

inline const std::filesystem::path kRobots = std::filesystem::path(SINEW_SOURCE_DIR) / "robots";

inline actuator::RobotModel RigRobot() {
  return actuator::LoadRobotModel(kRobots / "rig/model.yaml");
}

// The biped with a payload on its torso.
inline actuator::RobotModel LoadedBiped() {
  actuator::RobotModel robot = actuator::LoadRobotModel(kRobots / "biped/model.yaml");
  robot.payloads.push_back(
      {.link = "torso", .mass_kg = 4.0, .position_m = {0.03, 0.02, 0.0715}, .declared = false});
  return robot;
}

inline std::string UrdfText(const actuator::RobotModel& robot) {
  return config::ReadFile(robot.urdf_path);
}

inline arm::Chain UrdfChain(const actuator::RobotModel& robot) {
  return arm::ParseUrdf(UrdfText(robot), robot.urdf_path);
}

inline DescribedRobot Described(const actuator::RobotModel& robot) {
  return Describe(robot, UrdfChain(robot));
}

}  // namespace sinew::export_model
