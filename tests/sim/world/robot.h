// Robots on a floating base for tests: joint models in code, robots/biped in a squat, the foreign
// bipeds of ../shared/data/biped_12dof_urdf.
#pragma once

#include <cmath>
#include <fstream>
#include <sstream>
#include <string>

#include "components/base/types/control_mode.h"
#include "components/bodies/links/file/urdf_file.h"
#include "components/model/actuator/model.h"
#include "sim/world/floating_robot.h"
#include "tests/sim/world/biped.h"

namespace sinew::world {

struct DriveModel {
  double rotor_inertia_kg_m2 = 0.05;  // at the output
  double coulomb_Nm = 0.5;
};

// A drive with a gear, a rotor and friction for every moving joint that is not passive.
inline actuator::RobotModel ModelOf(const arm::Chain& chain, const DriveModel& drive = {}) {
  actuator::RobotModel model;
  for (const arm::Body& body : chain.bodies) {
    if (!body.moves || body.passive) continue;
    actuator::JointModel joint;
    joint.name = body.joint_name;
    joint.constants.torque_constant_Nm_A = 0.1;
    joint.constants.gear_ratio = 100.0;
    joint.motor_torque_limit_Nm = body.effort / joint.constants.gear_ratio;
    const auto add = [&joint](const char* effect, double value) {
      joint.terms.push_back(actuator::MakeTerm(effect, joint.constants));
      joint.terms.back().linear[0].value = value;
    };
    add("drive_current", 1.0);
    if (drive.rotor_inertia_kg_m2 > 0.0) add("rotor_inertia", drive.rotor_inertia_kg_m2);
    if (drive.coulomb_Nm > 0.0) add("coulomb", drive.coulomb_Nm);
    model.joints.push_back(joint);
  }
  return model;
}

// Angle of a joint whose legs are bent by `bend` in the hip and back in the ankle, twice in the
// knee: the soles stay level. 0 for other joints.
inline double SquatAngle(const std::string& joint, double bend_rad) {
  const auto has = [&joint](const char* part) { return joint.find(part) != std::string::npos; };
  if (has("hip_pitch") || has("ankle_pitch")) return -bend_rad;
  return has("knee") ? 2.0 * bend_rad : 0.0;
}

// robots/biped on its eight force sensors, knees bent by 0.6 rad.
inline FloatingRobotConfig SquattingBiped(const DriveModel& drive = {}) {
  std::ifstream stream(SINEW_SOURCE_DIR "/robots/biped/biped.urdf");
  std::ostringstream text;
  text << stream.rdbuf();
  FloatingRobotConfig config;
  config.chain = arm::ParseUrdf(text.str(), "biped.urdf");
  config.model = ModelOf(config.chain, drive);
  for (const actuator::JointModel& joint : config.model.joints) {
    WorldJointConfig& start = config.joints.emplace_back();
    start.position_rad = SquatAngle(joint.name, 0.3);
    start.plant.velocity_integral_1_s = 0.0;  // robots/biped/README.md, "Rocking"
  }
  for (const char* side : {"right", "left"}) {
    for (const char* place : {"rear_outer", "rear_inner", "front_outer", "front_inner"}) {
      config.contacts.push_back({.link = std::string(side) + "_force_" + place});
    }
  }
  config.imu_link = "imu";
  return config;
}

// The Berkeley Humanoid Lite on the corners of its feet (biped.h).
inline FloatingRobotConfig BerkeleyRobot() {
  const StandingBiped biped = MakeStandingBiped();
  FloatingRobotConfig config;
  config.chain = biped.config.chain;
  config.model = ModelOf(config.chain);
  for (const actuator::JointModel& joint : config.model.joints) {
    config.joints.emplace_back().position_rad = SquatAngle(joint.name, 0.2);
  }
  for (const ContactPoint& contact : biped.config.contacts) {
    config.contacts.push_back({.link = contact.name, .point_m = contact.point_m});
  }
  config.imu_link = "imu_2";
  return config;
}

inline const std::string kPai = "hightorque_pai_12dof.urdf";

// The HighTorque Pai; its feet are meshes that are not there: soles of 0.14 x 0.06 m, 0.04 m below
// the ankle, are assumed. With all joints at 0 its legs are bent and its soles level within 7 mrad.
inline FloatingRobotConfig PaiRobot() {
  FloatingRobotConfig config;
  config.chain = ReadBiped(kPai);
  config.model = ModelOf(config.chain);
  for (const char* side : {"r", "l"}) {
    for (const double x : {-0.05, 0.09}) {
      for (const double y : {-0.03, 0.03}) {
        config.contacts.push_back(
            {.link = std::string(side) + "_ankle_roll_link", .point_m = {x, y, -0.04}});
      }
    }
  }
  return config;
}

// Position mode in all joints, at their start.
inline provider::PlantCommand HoldStart(const FloatingRobotConfig& config) {
  provider::PlantCommand command;
  for (std::size_t j = 0; j < config.model.joints.size(); ++j) {
    command.mode[j] = types::ControlMode::kPosition;
    command.position_rad[j] = config.joints.empty() ? 0.0 : config.joints[j].position_rad;
  }
  return command;
}

// In the air, without stops and friction: what moves it once keeps its energy.
inline FloatingRobotConfig Flying(double substep_s) {
  FloatingRobotConfig config = SquattingBiped({.rotor_inertia_kg_m2 = 0.05, .coulomb_Nm = 0.0});
  for (arm::Body& body : config.chain.bodies) {
    body.upper = std::numeric_limits<double>::infinity();
    body.lower = -body.upper;
    if (body.passive) body.passive->damping_Nms_rad = 0.0;
  }
  config.base_height_m = 100.0;
  config.substep_s = substep_s;
  return config;
}

}  // namespace sinew::world
