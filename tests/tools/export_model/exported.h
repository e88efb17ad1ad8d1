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

// The rig with a finger beside it that its joint moves, on a base of that mass.
inline arm::Chain RigWithFinger(const actuator::RobotModel& rig, double base_kg = 0.0) {
  std::string text = UrdfText(rig);
  const arm::Chain plain = UrdfChain(rig);
  const std::string inertial =
      "<inertial><mass value=\"MASS\"/><inertia ixx=\"0.01\" ixy=\"0\" ixz=\"0\" "
      "iyy=\"0.01\" iyz=\"0\" izz=\"0.01\"/></inertial>";
  const auto of_mass = [&inertial](double mass_kg) {
    return std::string(inertial).replace(inertial.find("MASS"), 4, std::to_string(mass_kg));
  };
  text.insert(text.rfind("</robot>"),
              "<link name=\"finger\">" + of_mass(0.5) +
                  "</link><joint name=\"bend\" type=\"revolute\">"
                  "<parent link=\"" +
                  plain.base.link_name +
                  "\"/><child link=\"finger\"/><axis xyz=\"0 0 1\"/>"
                  "<limit lower=\"0\" upper=\"0\" effort=\"0\" velocity=\"1\"/>"
                  "<mimic joint=\"joint\" multiplier=\"-0.5\" offset=\"0.25\"/></joint>");
  if (base_kg != 0.0) {
    text.insert(text.rfind("</robot>"), "<link name=\"stand\">" + of_mass(base_kg) +
                                            "</link><joint name=\"bolts\" type=\"fixed\">"
                                            "<parent link=\"" +
                                            plain.base.link_name +
                                            "\"/><child link=\"stand\"/></joint>");
  }
  return arm::ParseUrdf(text, "finger.urdf");
}

// Its inertia and weight are the URDF's.
inline actuator::RobotModel RigOfBodies() {
  actuator::RobotModel rig = RigRobot();
  std::erase_if(rig.joints[0].terms, [](const actuator::Term& term) {
    const std::string& name = term.effect->info().name;
    return name == "link_inertia" || name == "gravity";
  });
  return rig;
}

inline DescribedRobot Described(const actuator::RobotModel& robot) {
  return Describe(robot, UrdfChain(robot));
}

}  // namespace sinew::export_model
