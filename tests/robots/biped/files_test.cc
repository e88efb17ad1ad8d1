// robots/biped: what the generator writes is there, and models, world, controllers and references
// describe one robot.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "components/bodies/leg/geometry.h"
#include "components/bodies/leg/squat.h"
#include "components/bodies/links/file/urdf_file.h"
#include "components/model/actuator/file/model_file.h"
#include "components/robot/control/file/control_file.h"
#include "components/robot/pneumatics/file/pneumatics_file.h"
#include "components/robot/reference/file/reference_file.h"
#include "sim/world/file/world_file.h"

namespace sinew {
namespace {

const std::string kRobot = SINEW_SOURCE_DIR "/robots/biped/";
constexpr std::size_t kDriven = 12;

std::string TextOf(const std::string& name) {
  std::ifstream in(kRobot + name, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

arm::Chain ChainOf(const std::string& name) { return arm::ParseUrdf(TextOf(name), name); }

std::vector<arm::Body> DrivenBodies(const arm::Chain& chain) {
  std::vector<arm::Body> driven;
  for (const arm::Body& body : chain.bodies) {
    if (body.moves && body.effort > 0.0) driven.push_back(body);
  }
  return driven;
}

bool HasElement(const std::string& joint_name) {
  return joint_name.find("knee") != std::string::npos ||
         joint_name.find("ankle_pitch") != std::string::npos;
}

TEST(BipedFiles, AreWhatTheGeneratorWrites) {
  for (const std::string name : {"biped.urdf", "biped_stand.urdf", "model.yaml",
                                 "model_sea_pea.yaml", "can_bridge.yaml", "virtual_axes.yaml"}) {
    const std::string command =
        std::string(SINEW_PYTHON) + " -B " + kRobot + "generate.py --print " + name;
    std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
    ASSERT_NE(pipe, nullptr);
    std::string written;
    std::array<char, 4096> block{};
    for (std::size_t n; (n = fread(block.data(), 1, block.size(), pipe.get())) > 0;) {
      written.append(block.data(), n);
    }
    ASSERT_GT(written.size(), 2000u) << command;
    EXPECT_TRUE(written == TextOf(name)) << "run robots/biped/generate.py and commit " << name;
  }
}

TEST(BipedFiles, TheRobotOnTheStandIsTheSameWithoutToesThatMove) {
  const arm::Chain robot = ChainOf("biped.urdf"), stand = ChainOf("biped_stand.urdf");
  ASSERT_EQ(robot.bodies.size(), stand.bodies.size());
  for (std::size_t i = 0; i < robot.bodies.size(); ++i) {
    const arm::Body &a = robot.bodies[i], &b = stand.bodies[i];
    EXPECT_EQ(a.link_name, b.link_name);
    EXPECT_EQ(a.mass_kg, b.mass_kg);
    EXPECT_EQ(a.inertia_kg_m2, b.inertia_kg_m2);
    EXPECT_EQ(b.moves, a.moves && a.effort > 0.0) << a.joint_name;
  }
}

TEST(BipedFiles, ModelsHaveTheDrivenJointsInTheirOrderAndTheirEffort) {
  const std::vector<arm::Body> driven = DrivenBodies(ChainOf("biped.urdf"));
  ASSERT_EQ(driven.size(), kDriven);
  constexpr double kPrinted_Nm = 0.005;  // of the URDF, and 6 digits of the model
  for (const char* name : {"model.yaml", "model_sea_pea.yaml"}) {
    const actuator::RobotModel model = actuator::LoadRobotModel(kRobot + name);
    ASSERT_EQ(model.joints.size(), kDriven) << name;
    for (std::size_t j = 0; j < kDriven; ++j) {
      const actuator::JointModel& joint = model.joints[j];
      EXPECT_EQ(joint.name, driven[j].joint_name);
      EXPECT_NEAR(joint.motor_torque_limit_Nm * joint.constants.gear_ratio *
                      joint.Parameter("drive_current", "efficiency"),
                  driven[j].effort, kPrinted_Nm + 1e-4)
          << joint.name;
      EXPECT_NEAR(joint.motor_torque_limit_Nm / joint.constants.torque_constant_Nm_A, 25.0, 1e-3);
      // Inertia and weight are the URDF's.
      for (const char* effect : {"link_inertia", "inertia", "gravity", "declared_payload"}) {
        EXPECT_LT(joint.Find(effect), 0) << joint.name << ' ' << effect;
      }
    }
  }
}

TEST(BipedFiles, TheKneeIsTheRigsActuatorAndTheOthersFollowFromIt) {
  const actuator::RobotModel model = actuator::LoadRobotModel(kRobot + "model.yaml");
  const actuator::JointModel rig =
      actuator::LoadRobotModel(SINEW_SOURCE_DIR "/robots/rig/model.yaml").joints.at(0);
  const actuator::JointModel& knee = model.joints[3];
  for (const auto& [effect, parameter] : {std::pair{"rotor_inertia", "rotor_inertia"},
                                          {"motor_viscous", "viscous"},
                                          {"coulomb", "coulomb"}}) {
    EXPECT_NEAR(knee.Parameter(effect, parameter), rig.Parameter(effect, parameter), 1e-6);
  }
  // Half the reduction: a quarter of what turns with the motor.
  EXPECT_NEAR(model.joints[0].Parameter("rotor_inertia", "rotor_inertia"),
              0.25 * knee.Parameter("rotor_inertia", "rotor_inertia"), 1e-6);
  // Rings of 50 x 8 and 35 x 10 mm, 1.5 mm beyond the stator's edge: h r^3 is 2.1705 times.
  const double of_motor = model.joints[2].Parameter("rotor_inertia", "rotor_inertia") / 6400.0;
  EXPECT_NEAR(of_motor / (knee.Parameter("rotor_inertia", "rotor_inertia") / 1e4), 2.1705, 1e-4);
}

// The element against the static torque of the joint, from the URDF: weights above it, half of the
// body, about its axis.
TEST(BipedFiles, AnElementCarriesHalfOfTheLoadAtTheLowestPointAndNothingAtItsLimit) {
  const actuator::RobotModel model = actuator::LoadRobotModel(kRobot + "model_sea_pea.yaml");
  const arm::Chain chain = ChainOf("biped.urdf");
  const leg::LegGeometry g = leg::GeometryOf(chain, leg::NamesOfSide("left"), "left_sole");
  const auto lowest = leg::SquatAt(g, 0.0, {leg::StraightHeight(g, 0.0) - 0.4, 0.0, 0.0});
  ASSERT_TRUE(lowest.has_value());
  const double hip = lowest->hip_pitch.position_rad, knee = lowest->knee.position_rad;
  // x of a point of a link that hangs at x0, turned about y.
  const auto forward = [](double angle, const Eigen::Vector3d& p) {
    return p.x() * std::cos(angle) + p.z() * std::sin(angle);
  };
  const double knee_x = g.thigh_m * std::sin(-hip);
  double above_knee_Nm = 0.0, above_ankle_Nm = 0.0;
  for (const arm::Body& body : chain.bodies) {
    const double weight_N = 9.81 * body.mass_kg;
    const std::string& link = body.link_name;
    if (link == "pelvis" || link == "torso") {
      above_knee_Nm += 0.5 * weight_N * (body.com_m.x() - knee_x);
      above_ankle_Nm += 0.5 * weight_N * body.com_m.x();
    } else if (link == "left_hip_yaw_link" || link == "left_hip_roll_link" ||
               link == "left_thigh") {
      const double x = forward(link == "left_thigh" ? hip : 0.0, body.com_m);
      above_knee_Nm += weight_N * (x - knee_x);
      above_ankle_Nm += weight_N * x;
    } else if (link == "left_shank") {
      above_ankle_Nm += weight_N * (knee_x + forward(hip + knee, body.com_m));
    }
  }
  struct Element {
    std::size_t joint;
    double static_Nm, lowest_rad, slack_rad;
  };
  for (const Element& e :
       {Element{3, above_knee_Nm, knee, 0.0}, {4, above_ankle_Nm, -hip - knee, 0.8}}) {
    for (const std::size_t j : {e.joint, e.joint + 6}) {
      const actuator::JointModel& joint = model.joints[j];
      const auto torque_Nm = [&joint](double position_rad) {
        return 4.0 * (joint.Parameter("pneumatic_torque", "pneumatic_torque") -
                      joint.Parameter("pneumatic_stiffness", "pneumatic_stiffness") *
                          (position_rad - joint.Parameter("pneumatic_stiffness", "rest_angle")));
      };
      EXPECT_NEAR(torque_Nm(e.lowest_rad), 0.5 * e.static_Nm, 1e-3) << joint.name;
      EXPECT_NEAR(torque_Nm(e.slack_rad), 0.0, 1e-3) << joint.name;
    }
  }
  for (const actuator::JointModel& joint : model.joints) {
    EXPECT_EQ(joint.backlash_rad > 0.0, HasElement(joint.name)) << joint.name;
    EXPECT_EQ(joint.Find("pneumatic_torque") >= 0, HasElement(joint.name)) << joint.name;
  }
}

TEST(BipedFiles, TheWorldBeginsWhereTheSquatsDo) {
  for (const char* model : {"model.yaml", "model_sea_pea.yaml"}) {
    const world::WorldFile stand =
        world::LoadWorldFile(kRobot + "world_stand.yaml", kRobot + model);
    EXPECT_EQ(world::MakeWorld(stand, "world_stand.yaml")->joint_count(), 12);
    const world::WorldFile ground = world::LoadWorldFile(kRobot + "world.yaml", kRobot + model);
    const auto robot = world::MakeWorld(ground, "world.yaml");
    EXPECT_EQ(robot->joint_count(), 12);
    ASSERT_NE(robot->body_sensors(), nullptr);
    EXPECT_TRUE(robot->body_sensors()->imu_valid);
    double feet_N = 0.0;
    for (const auto& force_N : robot->body_truth()->contact_force_N) feet_N += force_N[2];
    EXPECT_NEAR(feet_N, 17.1 * 9.81, 1e-6);
    // Its sensors are no ideal ones, within what the file states: bias 2 N, scale 2 %, five
    // deviations of 0.5 N.
    for (std::size_t i = 0; i < 8; ++i) {
      const double true_N = robot->body_truth()->contact_force_N[i][2];
      EXPECT_NEAR(robot->body_sensors()->foot_force_N[i], true_N, 4.5 + 0.02 * true_N);
      EXPECT_NE(robot->body_sensors()->foot_force_N[i], true_N);
    }
    EXPECT_NE(robot->body_sensors()->acceleration_m_s2[2], 9.81);
    for (const char* squat : {"reference_benchmark.yaml", "reference_six.yaml"}) {
      const reference::LoadedReference loaded = reference::LoadReference(kRobot + squat);
      for (std::size_t j = 0; j < kDriven; ++j) {
        const double begin_rad = loaded.config.joints[j].trajectory->At(0.0).position_rad;
        EXPECT_NEAR(stand.config.joints[j].position_rad, begin_rad, 1e-8);
        EXPECT_EQ(ground.config.joints[j].position_rad, stand.config.joints[j].position_rad);
        EXPECT_EQ(stand.config.joints[j].has_pneumatics,
                  HasElement(stand.config.model.joints[j].name));
      }
    }
  }
}

TEST(BipedFiles, TheWorldWithElementsBeginsAtThePressureThatIsHeld) {
  const world::WorldFile rigid = world::LoadWorldFile(kRobot + "world.yaml");
  const world::WorldFile elastic = world::LoadWorldFile(kRobot + "world_sea_pea.yaml");
  const auto managers = pneumatics::LoadPneumatics(kRobot + "pneumatics.yaml").joints;
  ASSERT_EQ(managers.size(), kDriven);
  ASSERT_TRUE(rigid.floating_base && elastic.floating_base);
  EXPECT_EQ(rigid.floating_base->ground.static_load_N, elastic.floating_base->ground.static_load_N);
  ASSERT_EQ(rigid.floating_base->contacts.size(), elastic.floating_base->contacts.size());
  for (std::size_t i = 0; i < rigid.floating_base->contacts.size(); ++i) {
    EXPECT_EQ(rigid.floating_base->contacts[i].link, elastic.floating_base->contacts[i].link);
  }
  for (std::size_t j = 0; j < kDriven; ++j) {
    const world::WorldJointConfig &a = rigid.config.joints[j], &b = elastic.config.joints[j];
    const bool has_element = HasElement(elastic.config.model.joints[j].name);
    EXPECT_EQ(a.position_rad, b.position_rad);
    EXPECT_EQ(a.motor_encoder_counts, b.motor_encoder_counts);
    EXPECT_EQ(b.has_pneumatics, has_element);
    EXPECT_EQ(managers[j].target_bar > 0.0, has_element);
    if (!has_element) continue;
    EXPECT_EQ(a.pneumatics.chamber_volume_m3, b.pneumatics.chamber_volume_m3);
    EXPECT_EQ(b.pneumatics.initial_pressure_bar, managers[j].target_bar);
    EXPECT_EQ(b.pneumatics.source_pressure_bar, managers[j].target_bar);
  }
}

TEST(BipedFiles, ControllersHaveAllJointsAndThePublishedGains) {
  const control::ControlConfig position = control::LoadControl(kRobot + "control_position.yaml");
  EXPECT_EQ(position.joints.size(), kDriven);
  for (const char* name : {"control_pid.yaml", "control_pid_drive.yaml"}) {
    for (const std::string model : {"", "model_sea_pea.yaml"}) {
      const control::ControlConfig pid =
          control::LoadControl(kRobot + name, model.empty() ? "" : kRobot + model);
      ASSERT_EQ(pid.joints.size(), kDriven);
      for (const control::JointControlConfig& joint : pid.joints) {
        EXPECT_EQ(joint.pid.proportional_Nm_rad, 60.0);
        EXPECT_EQ(joint.pid.integral_Nm_rad_s, 3.5);
        EXPECT_EQ(joint.pid.derivative_Nm_s_rad, 1.0);
      }
      EXPECT_EQ(pid.joints[3].gear_ratio, 100.0);  // each joint has its own drive
      EXPECT_EQ(pid.joints[8].gear_ratio, 80.0);
    }
  }
  for (const char* name : {"control_pid_tuned.yaml", "control_pid_sea_pea.yaml"}) {
    const control::ControlConfig pid = control::LoadControl(kRobot + name);
    ASSERT_EQ(pid.joints.size(), kDriven) << name;
    EXPECT_EQ(pid.joints[3].gear_ratio, 100.0);
    EXPECT_GT(pid.joints[0].pid.proportional_Nm_rad, 60.0) << "with the published ones it falls";
  }
}

}  // namespace
}  // namespace sinew
